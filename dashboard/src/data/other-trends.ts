// The histories of another machine, beside those of the one that is looked at.
import type { IdentificationSummary } from "../schemas/identifications";
import type { MachineRevision, Sense } from "../schemas/machines";
import type { Series, Trends } from "../schemas/trends";
import { queryString, type ApiError } from "./http-client";
import { useNewestOf } from "./newest-identification";
import { useResource } from "./resource";

const POLL_MS = 30_000;

export interface OtherTrends {
  series: Series[];
  /** Those of the parameters that the other machine has. */
  names: string[];
  /** How it turns; null while nothing is known of it. */
  rotation: Sense | null;
  isPending: boolean;
  /** Why there are no series, where it is not because there is no such history. */
  failure: ApiError | undefined;
}

/** The histories of another machine, of those parameters that it has too. */
export function useOtherTrends(machine: string | undefined, query: { parameter: string[]; from: string | null; to: string | null; scope: string; max_points: number }): OtherTrends {
  const path = machine ? `/machines/${encodeURIComponent(machine)}` : null;
  const machineOf = useResource<MachineRevision>(path);
  const list = useResource<IdentificationSummary[]>(path && `${path}/identifications?limit=20`);
  const newest = useNewestOf(list.data);
  const known = newest.data ? [...newest.data.estimates.map((one) => one.parameter), ...newest.data.derived.map((one) => one.name)] : [];
  const names = query.parameter.filter((one) => known.includes(one));
  const trends = useResource<Trends>(path && names.length > 0 ? `${path}/trends${queryString({ ...query, parameter: names })}` : null, POLL_MS);
  const isKnown = !path || list.failure || list.data?.length === 0 || newest.failure || (newest.data && (names.length === 0 || trends.data || trends.failure));
  const isTurningKnown = !path || machineOf.data || machineOf.failure;
  // What was loaded before a failure is shown.
  const failure = trends.data ? undefined : newest.data ? trends.failure : list.data ? newest.failure : list.failure;
  const rotation = machineOf.data ? (machineOf.data.document.rotation ?? "positive") : null;
  return { series: trends.data?.series ?? [], names, rotation, isPending: !isKnown || !isTurningKnown, failure };
}
