// The frame around every page: navigation, the page itself, keyboard shortcuts.
import { useEffect, useState } from "preact/hooks";
import { link, route } from "../browser/router";
import { useStore } from "../browser/store";
import { ErrorBoundary } from "../components/error-boundary";
import { MissingMachine } from "../components/missing";
import { connection } from "../data/connection";
import { t } from "../messages/messages";
import { AlertPage } from "../pages/alert-page";
import { AlertsPage } from "../pages/alerts-page";
import { FleetPage } from "../pages/fleet-page";
import { MachinePage } from "../pages/machine-page";
import { NotificationsPage } from "../pages/notifications-page";
import { ReportPage } from "../pages/report-page";
import { WallPage } from "../pages/wall-page";
import { ConnectionBanner, ConnectionState } from "./connection-state";
import { KeyboardShortcuts, useShortcuts } from "./keyboard-shortcuts";
import { LanguageSelect } from "./language-select";
import { ThemeButton } from "./theme-button";
import { UnitSelect } from "./unit-select";
import { UserName } from "./user-name";

/** Identifiers that a machine may have. */
const MACHINE = /^[A-Za-z0-9_-]{1,64}$/;

export function Shell() {
  const { parts } = useStore(route);
  const { state } = useStore(connection);
  const isStale = state === "lost" || state === "degraded";
  const [shortcuts, setShortcuts] = useState(false);
  useShortcuts(() => setShortcuts((open) => !open));
  useEffect(() => {
    document.title = ["Rundown", parts[1], parts[2]].filter(Boolean).join(" · ");
  }, [parts.join("/")]);
  return (
    <>
      <a class="skip" href="#main" onClick={skip}>
        {t("skipToTheContent")}
      </a>
      <header class="bar">
        <a class="brand" href="#/">
          Rundown
        </a>
        <Navigation first={parts[0]} />
        <span class="space" />
        <UserName />
        <ConnectionState />
        <UnitSelect />
        <LanguageSelect />
        <ThemeButton />
        <button type="button" class="quiet" onClick={() => setShortcuts(true)} aria-label={t("keyboardShortcuts")} title={t("keyboardShortcutsKey")}>
          ?
        </button>
      </header>
      <ConnectionBanner />
      <main id="main" tabIndex={-1} class={isStale ? "stale" : undefined}>
        <ErrorBoundary key={parts.slice(0, 2).join("/")}>
          <Page parts={parts} />
        </ErrorBoundary>
      </main>
      {shortcuts && <KeyboardShortcuts onClose={() => setShortcuts(false)} />}
    </>
  );
}

function skip(event: Event): void {
  event.preventDefault();
  document.getElementById("main")?.focus();
}

function Navigation({ first }: { first: string | undefined }) {
  const current = (part: string | undefined) => (first === part ? "page" : undefined);
  return (
    <nav aria-label={t("pages")}>
      <a href="#/" aria-current={current(undefined)}>
        {t("fleet")}
      </a>
      <a href={link(["alerts"])} aria-current={current("alerts")}>
        {t("alerts")}
      </a>
      <a href={link(["subscriptions"])} aria-current={current("subscriptions")} title={t("whoIsNotifiedOfAlerts")}>
        {t("notifications")}
      </a>
      <a href="/api/v1/docs">API</a>
    </nav>
  );
}

function Page({ parts }: { parts: string[] }) {
  const [first, machine, tab] = parts;
  if (first === undefined) return <FleetPage />;
  if (first === "alerts" && machine !== undefined) return <AlertPage key={machine} id={machine} />;
  if (first === "alerts") return <AlertsPage />;
  if (first === "wall") return <WallPage />;
  if (first === "subscriptions") return <NotificationsPage />;
  if (machine !== undefined && !MACHINE.test(machine)) return <MissingMachine id={encodeURIComponent(machine)} />;
  if (first === "machines" && machine) return <MachinePage key={machine} id={machine} tab={tab ?? "overview"} />;
  if (first === "reports" && machine) return <ReportPage key={machine} id={machine} />;
  return (
    <section class="panel">
      <h1>{t("noSuchPage")}</h1>
      <p>
        <a href="#/">{t("toTheFleet")}</a>
      </p>
    </section>
  );
}
