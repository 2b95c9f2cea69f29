// Choosing a run, and one to compare it with.
import { useEffect } from "preact/hooks";
import type { Run } from "../schemas/answers";
import { when } from "../words/format";
import { Cut } from "../components/parts";
import { useResource } from "./resource";
import { choose, place } from "../browser/router";
import { useStore } from "../browser/store";

/** So many are offered. */
const LISTED = 200;

export interface Runs {
  all: Run[] | undefined;
  /** How many the service listed, also those that cannot be chosen. */
  listed: number;
  run: Run | undefined;
  reference: Run | undefined;
  failure: string | undefined;
}

/** The newest runs, and those that the address names though they are older; the one chosen, and the one it is laid over. */
export function useRuns(machine: string): Runs {
  const { query } = useStore(place);
  const answer = useResource<Run[]>(`/machines/${machine}/runs?limit=${LISTED}`, 15_000);
  const older = [useOlder(answer.data, query.get("run")), useOlder(answer.data, query.get("reference"))];
  const waits = older.some((one) => one.waits);
  const found = older.map((one) => one.data).filter((one) => one?.machine === machine) as Run[];
  const all = waits ? undefined : answer.data && [...answer.data.filter((one) => one.state !== "discarded" && one.samples !== 0), ...found];
  const named = (name: string) => all?.find((one) => String(one.id) === query.get(name));
  // A run that is named but not there is not quietly replaced by another one.
  const run = query.get("run") ? named("run") : all?.find((one) => one.state === "closed");
  useEffect(() => {
    if (run && !query.get("run")) choose({ run: String(run.id) });
  }, [run?.id, query]);
  const failure = query.get("run") && all && !run ? `This machine has no run ${query.get("run")} to show.` : answer.failure?.message;
  return { all, listed: answer.data?.length ?? 0, run, reference: named("reference"), failure };
}

/** A run that the address names and the list has no longer. */
function useOlder(listed: Run[] | undefined, id: string | null): { data: Run | undefined; waits: boolean } {
  const wanted = listed && id && !listed.some((one) => String(one.id) === id) ? `/runs/${encodeURIComponent(id)}` : null;
  const { data, failure } = useResource<Run>(wanted);
  return { data, waits: wanted !== null && !data && !failure };
}

export function RunChoice({ all, listed, run, reference }: Runs) {
  const alike = all?.filter((one) => one.kind === run?.kind && one.id !== run?.id) ?? [];
  return (
    <>
      <label>
        Run
        <select value={run?.id ?? ""} onChange={(event) => choose({ run: event.currentTarget.value, reference: null })}>
          {!run && <option value="">none</option>}
          {all?.map((one) => (
            <option key={one.id} value={one.id}>
              {words(one)}
            </option>
          ))}
        </select>
      </label>
      <label>
        Laid over
        <select value={reference?.id ?? ""} onChange={(event) => choose({ reference: event.currentTarget.value || null })}>
          <option value="">none</option>
          {alike.map((one) => (
            <option key={one.id} value={one.id}>
              {words(one)}
            </option>
          ))}
        </select>
      </label>
      <Cut shown={listed} most={LISTED} of="runs" />
      {alike.length > 0 && (
        <button type="button" onClick={() => choose({ reference: String(alike.at(-1)!.id) })}>
          Over the oldest of its kind
        </button>
      )}
    </>
  );
}

function words(run: Run): string {
  return `${run.id}  ${run.kind}, ${when(run.started_at)}${run.state === "open" ? " (open)" : ""}`;
}
