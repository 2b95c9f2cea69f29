// Alerts with the severity that they had at a moment: it rises and falls while an alert is open, and its events tell when.
import type { Alert, AlertEvent } from "./answers";
import { useResources, type Answer } from "./resource";

/** The service answers with so many at most. */
const MOST_EVENTS = 1000;

/** Alerts opened later are as they are now. Nothing until it is known how severe the others were. */
export function useAlertsAt(alerts: Alert[] | undefined, at: string): Answer<Alert[]> {
  const changed = (alerts ?? []).filter((one) => notAfter(one.opened_at, at) && !notAfter(one.updated_at, at));
  const events = useResources<AlertEvent[]>(changed.map((one) => `/alerts/${one.id}/events?limit=${MOST_EVENTS}`));
  const failure = events.find((one) => one.failure)?.failure;
  if (!alerts || events.some((one) => !one.data)) return { data: undefined, failure };
  const severity = new Map(changed.map((one, index) => [one.id, severityAt(events[index]!.data!, at)]));
  return { data: alerts.map((one) => ({ ...one, severity: severity.get(one.id) ?? one.severity })), failure };
}

/** That of the last event until then; the oldest event comes first. */
function severityAt(events: AlertEvent[], at: string): string | undefined {
  return events.filter((one) => notAfter(one.at, at)).at(-1)?.severity;
}

function notAfter(moment: string, at: string): boolean {
  return Date.parse(moment) <= Date.parse(at);
}
