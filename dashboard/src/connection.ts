// Whether the service answers, and what it says of alerts as it happens.
import type { AlertEvent } from "./answers";
import { findOut } from "./session";
import { Store } from "./store";

export interface Connection {
  state: "connecting" | "live" | "lost";
  /** Since when [ms]. */
  since: number;
}

/** How long to wait between two tries [ms]. */
const RETRY_MS = 1000;
/** The service is asked as often as this whether it is there: a frozen one keeps its connections open [ms]. */
const BEAT_MS = 4000;
const BEAT_PATIENCE_MS = 3000;
/** From one beat of another page to its next. */
const BEAT_SLACK_MS = BEAT_MS - BEAT_PATIENCE_MS;
const EVENTS = "/api/v1/alert-events/stream";
const BEAT = "/api/v1/alert-events?limit=1";

export const connection = new Store<Connection>({ state: "connecting", since: Date.now() });
/** The newest alert event; followers are told of each. */
export const newestEvent = new Store<AlertEvent | null>(null);
/** Grows each time the service is back, or the page is seen again: whoever shows something asks again. */
export const returns = new Store(0);

let stream: EventSource | null = null;
let retry: number | undefined;
/** Whether something may have happened that this page was not told: it was not seen, or nobody answered. */
let behind = document.hidden;
/** When the service last answered a page of this browser [ms]. */
let heardAt = 0;
/** Pages of this browser share its few connections: one that waits for a free one hears from the others that the service is there. */
const pages = new BroadcastChannel("rundown.heard");

function become(state: Connection["state"]): void {
  if (connection.value.state !== state) connection.set({ state, since: Date.now() });
}

/** The service answered. */
export function heard(): void {
  heardAt = Date.now();
  pages.postMessage(null);
}

/** A question was not answered. asked: when it was asked [ms]. */
export function missed(asked: number, error: unknown): void {
  const waited = error instanceof DOMException && error.name === "TimeoutError";
  if (!waited || heardAt < asked - BEAT_SLACK_MS) lose();
}

function lose(): void {
  become("lost");
  close();
  if (!document.hidden) retry = window.setTimeout(listen, RETRY_MS);
}

function close(): void {
  behind = true;
  window.clearTimeout(retry);
  stream?.close();
  stream = null;
}

function listen(): void {
  const after = newestEvent.value ? `?after=${newestEvent.value.id}` : "";
  const opened = new EventSource(EVENTS + after);
  stream = opened;
  opened.onopen = () => {
    become("live");
    if (behind) returns.set(returns.value + 1);
    behind = false;
  };
  opened.onerror = () => {
    if (stream !== opened) return;
    lose();
    void findOut(); // a stream does not say why it ended: the session may be over
  };
  opened.addEventListener("alert", (message) => {
    newestEvent.set(JSON.parse((message as MessageEvent<string>).data) as AlertEvent);
  });
}

/** A browser has six connections to a service over HTTP/1.1, for all of its pages: one that is not seen holds none. */
function seenOrNot(): void {
  close();
  if (connection.value.state === "live") become("connecting");
  if (!document.hidden) listen();
}

async function beat(): Promise<void> {
  if (connection.value.state === "lost" || document.hidden) return;
  const asked = Date.now();
  try {
    await fetch(BEAT, { signal: AbortSignal.timeout(BEAT_PATIENCE_MS) });
    heard();
  } catch (error) {
    missed(asked, error);
  }
}

export function connect(): void {
  pages.onmessage = () => (heardAt = Date.now());
  document.addEventListener("visibilitychange", seenOrNot);
  if (!document.hidden) listen();
  window.setInterval(() => void beat(), BEAT_MS);
}
