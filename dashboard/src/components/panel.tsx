// A section of a page with its heading, and its content when there is nothing to show or not all is shown.
import type { ComponentChildren } from "preact";
import { t, term } from "../messages/messages";

export function Panel(props: { title: string; aside?: ComponentChildren; class?: string; children: ComponentChildren }) {
  return (
    <section class={`panel ${props.class ?? ""}`}>
      <header>
        <h2>{props.title}</h2>
        {props.aside}
      </header>
      {props.children}
    </section>
  );
}

export function Empty({ children }: { children: ComponentChildren }) {
  return <p class="empty">{children}</p>;
}

/** State that a list may be longer than shown. which: the part that is shown. of: the list's name. */
export function Truncated({ shown, limit, which = "newest", of = "" }: { shown: number; limit: number; which?: string; of?: string }) {
  return shown < limit ? null : (
    <p class="muted truncated">
      {t("theNewestAreShown", { which: term(which), limit, of: of && ` ${of}` })}
    </p>
  );
}
