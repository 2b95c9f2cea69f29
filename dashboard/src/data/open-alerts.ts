// The open alerts of a machine.
import type { Alert } from "../schemas/alerts";
import { queryString } from "./http-client";
import { useResource, type QueryResult } from "./resource";

export const MAX_OPEN_ALERTS = 200;

export function openAlertsPath(machine: string): string {
  return `/machines/${machine}/alerts${queryString({ open: true, limit: MAX_OPEN_ALERTS })}`;
}

export function useOpenAlerts(machine: string): QueryResult<Alert[]> {
  return useResource<Alert[]>(openAlertsPath(machine), 10_000);
}
