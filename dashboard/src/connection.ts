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
const EVENTS = "/api/v1/alert-events/stream";
const BEAT = "/api/v1/alert-events?limit=1";

export const connection = new Store<Connection>({ state: "connecting", since: Date.now() });
/** The newest alert event; followers are told of each. */
export const newestEvent = new Store<AlertEvent | null>(null);
/** Grows each time the service is back: whoever shows something asks again. */
export const returns = new Store(0);

let stream: EventSource | null = null;
let retry: number | undefined;

function become(state: Connection["state"]): void {
  const before = connection.value.state;
  if (before === state) return;
  connection.set({ state, since: Date.now() });
  if (before === "lost" && state === "live") returns.set(returns.value + 1);
}

/** Something could not be asked for because nobody answered. */
export function missed(): void {
  become("lost");
  stream?.close();
  stream = null;
  retry ??= window.setTimeout(listen, RETRY_MS);
}

function listen(): void {
  retry = undefined;
  const after = newestEvent.value ? `?after=${newestEvent.value.id}` : "";
  const opened = new EventSource(EVENTS + after);
  stream = opened;
  opened.onopen = () => become("live");
  opened.onerror = () => {
    if (stream !== opened) return;
    missed();
    void findOut(); // a stream does not say why it ended: the session may be over
  };
  opened.addEventListener("alert", (message) => {
    newestEvent.set(JSON.parse((message as MessageEvent<string>).data) as AlertEvent);
  });
}

async function beat(): Promise<void> {
  if (connection.value.state !== "live" || document.hidden) return;
  try {
    await fetch(BEAT, { signal: AbortSignal.timeout(BEAT_PATIENCE_MS) });
  } catch {
    missed();
  }
}

export function connect(): void {
  listen();
  window.setInterval(() => void beat(), BEAT_MS);
}
