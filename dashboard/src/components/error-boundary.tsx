// A boundary around a view: if the view fails, the error is shown in its place and the rest of the page stays.
import type { ComponentChildren } from "preact";
import { useErrorBoundary } from "preact/hooks";
import { refetch } from "../data/resource";
import { t } from "../messages/messages";

export function ErrorBoundary({ children }: { children: ComponentChildren }) {
  const [error, reset] = useErrorBoundary((one) => console.error(one)) as [Error | undefined, () => void];
  if (!error) return <>{children}</>;
  const tryAgain = () => {
    void refetch(""); // the data that it failed on may have changed
    reset();
  };
  return (
    <section class="panel" role="alert">
      <p class="error">{t("viewHasError", { error: error.message })}</p>
      <p class="buttons">
        <button type="button" onClick={tryAgain}>
          {t("tryAgain")}
        </button>
      </p>
    </section>
  );
}
