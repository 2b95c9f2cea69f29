// Alerts as they were at a past moment: their events tell severity, state and message at that time.
import type { Alert, AlertEvent } from "../schemas/alerts";
import { useResources, type QueryResult } from "./resource";

/** The API's limit for a page of events. */
export const MAX_EVENTS = 1000;

/** Alerts opened later stay as they are now. No data until the events of all others are there. */
export function useAlertsAt(alerts: Alert[] | undefined, at: string): QueryResult<Alert[]> {
  const changed = (alerts ?? []).filter((one) => notAfter(one.opened_at, at) && !notAfter(one.updated_at, at));
  const events = useResources<AlertEvent[]>(changed.map((one) => `/alerts/${one.id}/events?limit=${MAX_EVENTS}`));
  const { failure, asOf } = events.find((one) => one.failure) ?? {};
  if (!alerts || events.some((one) => !one.data)) return { data: undefined, failure };
  const last = new Map(changed.map((one, index) => [one.id, lastUntil(events[index]!.data!, at)]));
  return { data: alerts.map((one) => asAfter(one, last.get(one.id))), failure, asOf };
}

/** The last event until then; the oldest comes first. */
function lastUntil(events: AlertEvent[], at: string): AlertEvent | undefined {
  return events.filter((one) => notAfter(one.at, at)).at(-1);
}

function asAfter(alert: Alert, event: AlertEvent | undefined): Alert {
  return event ? { ...alert, severity: event.severity, state: event.state, message: event.message, advice: event.advice ?? null } : alert;
}

function notAfter(moment: string, at: string): boolean {
  return Date.parse(moment) <= Date.parse(at);
}
