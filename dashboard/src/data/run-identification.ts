// The identification of a run alone, and the slow roll without which the run is shown beside it.
import type { IdentificationSummary, Run } from "../schemas/answers";
import { query, type Failure } from "./http-client";
import { useResource } from "./resource";

/** Where there is none yet it is looked for as often as this. */
const MS = 5000;

export interface FitOfRun {
  identified: IdentificationSummary | undefined;
  /** What phasors and orbits are asked for without; null while it is not known. */
  slowRoll: string | null;
  /** Why it is not known whether there is one. */
  failure: Failure | undefined;
}

/** Points and curve agree only where both are without the same vectors; without a curve those in force are as good as any. */
export function useFitOf(machine: string, run: Run | undefined): FitOfRun {
  const path = run?.ended_at ? measuredIn(machine, run.started_at, run.ended_at) : null;
  const listed = useResource<IdentificationSummary[]>(path);
  const identified = listed.data?.find((one) => one.accepted && one.scope === "run" && run && one.runs.includes(run.id));
  useResource(identified ? null : path, MS);
  const waits = !run || (run.ended_at && !listed.data && !listed.failure);
  return { identified, slowRoll: waits ? null : identified ? String(identified.slow_roll_version ?? "none") : "in_force", failure: listed.failure };
}

/** Where identifications of a run are asked for: they are measured when it ends. */
function measuredIn(machine: string, begin: string, end: string): string {
  const to = new Date(Date.parse(end) + 1000).toISOString();
  return `/machines/${machine}/identifications${query({ from: begin, to, limit: 100 })}`;
}

/** What an answer is without. leftOut: channels that the vectors are not of. */
export function slowRollWords(version: number | null, leftOut: string[] = []): string {
  if (version === null) return "as measured, no slow roll subtracted";
  return `slow roll version ${version} subtracted${leftOut.length > 0 ? `, but not at ${leftOut.join(", ")}` : ""}`;
}
