// How the newest identification of a machine deviates from its baseline.
import type { Deviations } from "../schemas/trends";
import type { ApiError } from "./http-client";
import { useLastComplete } from "./last-complete";
import { isComparable, type NewestSummary } from "./newest-identification";
import { useResource, type QueryResult } from "./resource";

interface MachineDeviations {
  deviations: QueryResult<Deviations>;
  /** Why those of the next identification are not there yet. */
  next: ApiError | undefined;
}

/** Those of the identification before it until those of the newest are loaded. */
export function useDeviations(machine: string, { data: newest, failure, asOf }: NewestSummary): MachineDeviations {
  const found = useResource<Deviations>(isComparable(newest) ? `/machines/${machine}/deviations?identification=${newest.id}` : null);
  const before = useLastComplete(machine, found.data);
  if (found.data || found.failure?.rejected || !before || !isComparable(newest)) {
    return { deviations: { data: found.data, failure: found.failure ?? failure, asOf: found.asOf ?? asOf }, next: undefined };
  }
  return { deviations: { data: before, failure, asOf }, next: found.failure };
}
