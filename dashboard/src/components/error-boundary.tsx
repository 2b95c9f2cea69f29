// Around a view: one that fails says so in its own place, and the rest of the page stays.
import type { ComponentChildren } from "preact";
import { useErrorBoundary } from "preact/hooks";
import { refresh } from "../data/resource";

export function Guard({ children }: { children: ComponentChildren }) {
  const [error, reset] = useErrorBoundary((one) => console.error(one)) as [Error | undefined, () => void];
  if (!error) return <>{children}</>;
  const tryAgain = () => {
    refresh(""); // what it failed on may be answered otherwise by now
    reset();
  };
  return (
    <section class="panel" role="alert">
      <p class="trouble">This view cannot be shown, the page has an error: {error.message}</p>
      <p class="buttons">
        <button type="button" onClick={tryAgain}>
          Try again
        </button>
      </p>
    </section>
  );
}
