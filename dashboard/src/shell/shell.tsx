// The frame around every page: where one is, whether the service answers, light and dark.
import { useEffect, useState } from "preact/hooks";
import { AlertsPage } from "../pages/alerts-page";
import { connection } from "../data/connection";
import { Fleet } from "../pages/fleet-page";
import { clock } from "../words/format";
import { Guard } from "../components/error-boundary";
import { Keys, useShortcuts } from "./keyboard-shortcuts";
import { MachinePage } from "../pages/machine-page";
import { Report } from "../pages/report-page";
import { link, place } from "../browser/router";
import { logOut, me } from "../data/session";
import { useStore } from "../browser/store";
import { SubscriptionsPage } from "../pages/notifications-page";
import { choice, choose, type Choice } from "../browser/theme";

/** What a machine may be called. */
const MACHINE = /^[A-Za-z0-9_-]{1,64}$/;

export function Shell() {
  const { parts } = useStore(place);
  const { state } = useStore(connection);
  const stale = state === "lost" || state === "troubled";
  const [keys, setKeys] = useState(false);
  useShortcuts(() => setKeys((open) => !open));
  useEffect(() => {
    document.title = ["Rundown", parts[1], parts[2]].filter(Boolean).join(" · ");
  }, [parts.join("/")]);
  return (
    <>
      <a class="skip" href="#main" onClick={skip}>
        Skip to the content
      </a>
      <header class="bar">
        <a class="brand" href="#/">
          Rundown
        </a>
        <nav aria-label="Pages">
          <a href="#/" aria-current={parts.length === 0 ? "page" : undefined}>
            Fleet
          </a>
          <a href={link(["alerts"])} aria-current={parts[0] === "alerts" ? "page" : undefined}>
            Alerts
          </a>
          <a href={link(["subscriptions"])} aria-current={parts[0] === "subscriptions" ? "page" : undefined} title="Who is told of alerts">
            Told
          </a>
          <a href="/api/v1/docs">API</a>
        </nav>
        <span class="space" />
        <Person />
        <Signal />
        <ThemeChoice />
        <button type="button" class="quiet" onClick={() => setKeys(true)} aria-label="Keys of this page" title="Keys (?)">
          ?
        </button>
      </header>
      <Banner />
      <main id="main" tabIndex={-1} class={stale ? "stale" : undefined}>
        <Guard key={parts.slice(0, 2).join("/")}>
          <Page parts={parts} />
        </Guard>
      </main>
      {keys && <Keys onClose={() => setKeys(false)} />}
    </>
  );
}

function skip(event: Event): void {
  event.preventDefault();
  document.getElementById("main")?.focus();
}

function Page({ parts }: { parts: string[] }) {
  const [first, machine, tab] = parts;
  if (first === undefined) return <Fleet />;
  if (first === "alerts") return <AlertsPage />;
  if (first === "subscriptions") return <SubscriptionsPage />;
  if (machine !== undefined && !MACHINE.test(machine)) return <p class="trouble" role="alert">There is no machine “{encodeURIComponent(machine)}”.</p>;
  if (first === "machines" && machine) return <MachinePage key={machine} id={machine} tab={tab ?? "overview"} />;
  if (first === "reports" && machine) return <Report key={machine} id={machine} />;
  return (
    <section class="panel">
      <h1>No such page</h1>
      <p>
        <a href="#/">To the fleet</a>
      </p>
    </section>
  );
}

function Person() {
  const who = useStore(me);
  if (who?.kind !== "session") return null;
  return (
    <span class="signal">
      {who.name} ({who.role}){" "}
      <button type="button" class="quiet" onClick={() => void logOut()}>
        Log out
      </button>
    </span>
  );
}

function Signal() {
  const { state } = useStore(connection);
  const said = { connecting: "○ connecting", live: "● live", troubled: "✕ no data", lost: "✕ no connection" }[state];
  return (
    <span class={`signal ${state}`} role="status">
      {said}
    </span>
  );
}

function Banner() {
  const { state, since, why } = useStore(connection);
  if (state === "troubled") {
    return (
      <div class="banner" role="alert">
        <strong>The service answers, but cannot read its data since {clock(since)}:</strong> {why} What is shown is from before. It is
        tried again every few seconds; the page goes on by itself.
      </div>
    );
  }
  if (state !== "lost") return null;
  return (
    <div class="banner" role="alert">
      <strong>The service does not answer since {clock(since)}.</strong> What is shown is from before. It is tried again every
      second; nothing needs to be done here.
    </div>
  );
}

function ThemeChoice() {
  const now = useStore(choice);
  const next: Record<Choice, Choice> = { system: "light", light: "dark", dark: "system" };
  const glyph: Record<Choice, string> = { system: "◐", light: "☼", dark: "☾" };
  return (
    <button
      type="button"
      class="quiet theme"
      onClick={() => choose(next[now])}
      aria-label={`Colours: ${now}; change to ${next[now]}`}
      title={`Colours: ${now} (d)`}
    >
      {glyph[now]}
    </button>
  );
}
