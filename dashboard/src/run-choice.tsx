// Choosing a run, and one to compare it with.
import type { Run } from "./answers";
import { when } from "./format";
import { useResource } from "./resource";
import { choose, place } from "./router";
import { useStore } from "./store";

export interface Runs {
  all: Run[] | undefined;
  run: Run | undefined;
  reference: Run | undefined;
  failure: string | undefined;
}

/** Closed runs, newest first; the one chosen in the address, and the one it is laid over. */
export function useRuns(machine: string): Runs {
  const { query } = useStore(place);
  const answer = useResource<Run[]>(`/machines/${machine}/runs?limit=200`, 15_000);
  const all = answer.data?.filter((one) => one.state !== "discarded" && one.samples !== 0);
  const named = (name: string) => all?.find((one) => String(one.id) === query.get(name));
  const run = named("run") ?? all?.find((one) => one.state === "closed");
  return { all, run, reference: named("reference"), failure: answer.failure?.message };
}

export function RunChoice({ all, run, reference }: Runs) {
  const alike = all?.filter((one) => one.kind === run?.kind && one.id !== run?.id) ?? [];
  return (
    <>
      <label>
        Run
        <select value={run?.id} onChange={(event) => choose({ run: event.currentTarget.value, reference: null })}>
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
