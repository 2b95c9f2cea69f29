// The connection to the service: the stream of alert events, and a heartbeat that finds out whether the service answers.
import { Store } from "../browser/store";
import type { AlertEvent } from "../schemas/alerts";
import { problemText } from "./problem";
import { loadCurrentUser } from "./session";

export interface Connection {
  /** degraded: the service answers, but cannot read its data. */
  state: "connecting" | "live" | "degraded" | "lost";
  /** When this state began [ms]. */
  since: number;
  /** The service's own reason for being degraded. */
  reason: string;
}

/** Between two attempts to open the stream [ms]. */
const RECONNECT_MS = 1000;
/** A frozen service keeps its connections open: only a request finds out that it does not answer [ms]. */
const HEARTBEAT_MS = 4000;
const HEARTBEAT_TIMEOUT_MS = 3000;
/** From one heartbeat of another tab to its next. */
const HEARTBEAT_SLACK_MS = HEARTBEAT_MS - HEARTBEAT_TIMEOUT_MS;
/** A proxy's statuses for a service behind it that does not answer. */
const BAD_GATEWAY = [502, 504];
const STREAM = "/api/v1/alert-events/stream";
const HEARTBEAT = "/api/v1/alert-events?limit=1";

export const connection = new Store<Connection>({ state: "connecting", since: Date.now(), reason: "" });
/** The newest alert event; subscribers are notified of each. */
export const latestAlertEvent = new Store<AlertEvent | null>(null);
/** Counts how often the service was back, or the tab seen again, after events may have been missed. */
export const reconnects = new Store(0);

let stream: EventSource | null = null;
let reconnect: number | undefined;
/** Whether events may have been missed: the tab was hidden, or the service did not answer. */
let mayHaveMissedEvents = document.hidden;
/** When the service last answered a tab of this browser [ms]. */
let lastResponseAt = 0;
/** Tabs share the browser's few connections: one that waits for a free one learns from the others that the service answers. */
const otherTabs = new BroadcastChannel("rundown.heard");

function setState(state: Connection["state"], reason = ""): void {
  const before = connection.value;
  if (before.state !== state || before.reason !== reason) connection.set({ state, since: before.state === state ? before.since : Date.now(), reason });
}

/** Note that the service responded, if only with an error. */
export function noteResponse(): void {
  lastResponseAt = Date.now();
  otherTabs.postMessage(null);
}

export function isTimeout(error: unknown): boolean {
  return error instanceof DOMException && error.name === "TimeoutError";
}

/** Note that a request got no response. sentAt: when it was sent [ms]. */
export function noteNoResponse(sentAt: number, error: unknown): void {
  if (!isTimeout(error) || lastResponseAt < sentAt - HEARTBEAT_SLACK_MS) setLost();
}

function setLost(): void {
  setState("lost");
  scheduleReconnect();
}

/** The service responds, but with a server error. */
function setDegraded(reason: string): void {
  setState("degraded", reason);
  mayHaveMissedEvents = true;
}

function setLive(): void {
  setState("live");
  if (mayHaveMissedEvents) reconnects.set(reconnects.value + 1);
  mayHaveMissedEvents = false;
}

function scheduleReconnect(): void {
  closeStream();
  if (!document.hidden) reconnect = window.setTimeout(openStream, RECONNECT_MS);
}

function closeStream(): void {
  mayHaveMissedEvents = true;
  window.clearTimeout(reconnect);
  stream?.close();
  stream = null;
}

function openStream(): void {
  const after = latestAlertEvent.value ? `?after=${latestAlertEvent.value.id}` : "";
  const opened = new EventSource(STREAM + after);
  stream = opened;
  opened.onopen = () => {
    // A stream opens without reading any data: only the heartbeat ends the degraded state.
    if (connection.value.state !== "degraded") setLive();
    void heartbeat();
  };
  opened.onerror = () => {
    if (stream !== opened) return;
    if (connection.value.state === "degraded") scheduleReconnect();
    else setLost();
    void heartbeat(); // the service may answer all the same
    void loadCurrentUser(); // a stream does not say why it ended: the session may have expired
  };
  opened.addEventListener("alert", (message) => {
    latestAlertEvent.set(JSON.parse((message as MessageEvent<string>).data) as AlertEvent);
  });
}

/** A browser has six connections to a host over HTTP/1.1, for all tabs together: a hidden tab holds none. */
function onVisibilityChange(): void {
  closeStream();
  if (connection.value.state === "live") setState("connecting");
  if (!document.hidden) openStream();
}

async function heartbeat(): Promise<void> {
  if (document.hidden) return;
  const sentAt = Date.now();
  try {
    const response = await fetch(HEARTBEAT, { signal: AbortSignal.timeout(HEARTBEAT_TIMEOUT_MS) });
    if (BAD_GATEWAY.includes(response.status)) return setLost();
    noteResponse();
    if (response.status >= 500) setDegraded(await problemText(response));
    else if (connection.value.state === "degraded") {
      if (stream?.readyState === EventSource.OPEN) setLive();
      else setState("connecting");
    }
  } catch (error) {
    if (connection.value.state !== "lost") noteNoResponse(sentAt, error);
  }
}

export function connect(): void {
  otherTabs.onmessage = () => (lastResponseAt = Date.now());
  document.addEventListener("visibilitychange", onVisibilityChange);
  if (!document.hidden) openStream();
  window.setInterval(() => void heartbeat(), HEARTBEAT_MS);
}
