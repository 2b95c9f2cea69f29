// Whether the service answers, and what it says of alerts as it happens.
import type { AlertEvent } from "../schemas/answers";
import { reason } from "./problem";
import { findOut } from "./session";
import { Store } from "../browser/store";

export interface Connection {
  /** troubled: the service answers, but cannot read its data. */
  state: "connecting" | "live" | "troubled" | "lost";
  /** Since when [ms]. */
  since: number;
  /** What the service says of its trouble. */
  why: string;
}

/** How long to wait between two tries [ms]. */
const RETRY_MS = 1000;
/** The service is asked as often as this whether it is there: a frozen one keeps its connections open [ms]. */
const BEAT_MS = 4000;
const BEAT_PATIENCE_MS = 3000;
/** From one beat of another page to its next. */
const BEAT_SLACK_MS = BEAT_MS - BEAT_PATIENCE_MS;
/** With these a proxy says that the service behind it does not answer. */
const BEHIND_A_PROXY = [502, 504];
const EVENTS = "/api/v1/alert-events/stream";
const BEAT = "/api/v1/alert-events?limit=1";

export const connection = new Store<Connection>({ state: "connecting", since: Date.now(), why: "" });
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

function become(state: Connection["state"], why = ""): void {
  const before = connection.value;
  if (before.state !== state || before.why !== why) connection.set({ state, since: before.state === state ? before.since : Date.now(), why });
}

/** The service answered, if only that it cannot. */
export function heard(): void {
  heardAt = Date.now();
  pages.postMessage(null);
}

export function timedOut(error: unknown): boolean {
  return error instanceof DOMException && error.name === "TimeoutError";
}

/** A question was not answered. asked: when it was asked [ms]. */
export function missed(asked: number, error: unknown): void {
  if (!timedOut(error) || heardAt < asked - BEAT_SLACK_MS) lose();
}

function lose(): void {
  become("lost");
  listenAgain();
}

/** It answers, but with a fault of its own. */
function trouble(why: string): void {
  become("troubled", why);
  behind = true;
}

/** All is well: whoever shows something asks again, if something may have been missed. */
function recover(): void {
  become("live");
  if (behind) returns.set(returns.value + 1);
  behind = false;
}

function listenAgain(): void {
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
    // A stream opens without any data to read: only the beat tells that a trouble is over.
    if (connection.value.state !== "troubled") recover();
    void beat();
  };
  opened.onerror = () => {
    if (stream !== opened) return;
    if (connection.value.state === "troubled") listenAgain();
    else lose();
    void beat(); // it may answer all the same
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
  if (document.hidden) return;
  const asked = Date.now();
  try {
    const answer = await fetch(BEAT, { signal: AbortSignal.timeout(BEAT_PATIENCE_MS) });
    if (BEHIND_A_PROXY.includes(answer.status)) return lose();
    heard();
    if (answer.status >= 500) trouble(await reason(answer));
    else if (connection.value.state === "troubled") {
      if (stream?.readyState === EventSource.OPEN) recover();
      else become("connecting");
    }
  } catch (error) {
    if (connection.value.state !== "lost") missed(asked, error);
  }
}

export function connect(): void {
  pages.onmessage = () => (heardAt = Date.now());
  document.addEventListener("visibilitychange", seenOrNot);
  if (!document.hidden) listen();
  window.setInterval(() => void beat(), BEAT_MS);
}
