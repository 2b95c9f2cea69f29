// The identification of a single run, and the slow roll to subtract from the run's phasors so that they match its curve.
import type { IdentificationSummary } from "../schemas/identifications";
import type { Run } from "../schemas/runs";
import { queryString, type ApiError } from "./http-client";
import { useResource } from "./resource";
import { isDwells } from "./run-selection";

/** While there is no identification of the run yet. */
const POLL_MS = 5000;

export interface RunIdentification {
  identified: IdentificationSummary | undefined;
  /** The API's parameter slow_roll for phasors and orbits; null while it is not known. */
  slowRoll: string | null;
  /** Why it is not known whether there is an identification. */
  failure: ApiError | undefined;
}

/** Of dwells there are variants only, and of those the newest is taken. Points and curve agree only with the same vectors subtracted; without a curve those in force are subtracted. */
export function useRunIdentification(machine: string, run: Run | undefined): RunIdentification {
  const path = run?.ended_at ? listPath(machine, run.started_at, run.ended_at) : null;
  const list = useResource<IdentificationSummary[]>(path);
  const identified = list.data?.find((one) => one.accepted && run && one.runs.includes(run.id) && (one.scope === "run" || isDwells(run)));
  useResource(identified ? null : path, POLL_MS);
  const isPending = !run || (run.ended_at && !list.data && !list.failure);
  return { identified, slowRoll: isPending ? null : identified ? String(identified.slow_roll_version ?? "none") : "in_force", failure: list.failure };
}

/** An identification is dated at the end of its run. */
function listPath(machine: string, begin: string, end: string): string {
  const to = new Date(Date.parse(end) + 1000).toISOString();
  return `/machines/${machine}/identifications${queryString({ from: begin, to, limit: 100 })}`;
}
