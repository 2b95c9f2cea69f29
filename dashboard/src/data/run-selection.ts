// The run that the address selects, and the one overlaid on it.
import { useEffect } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { t } from "../messages/messages";
import type { Run } from "../schemas/runs";
import { useResource } from "./resource";

/** Runs that can be chosen from. */
export const MAX_RUNS = 200;

export interface RunSelection {
  all: Run[] | undefined;
  /** How many the service listed, also those that cannot be selected. */
  listed: number;
  run: Run | undefined;
  reference: Run | undefined;
  failure: string | undefined;
}

/** Whether somebody made the run of dwells: it is discarded as a sweep, and shown all the same. */
export function isDwells(run: Run): boolean {
  return run.kind === "dwells";
}

/** The newest runs, and older ones that the address names; the one selected, and its reference. */
export function useRunSelection(machine: string): RunSelection {
  const { query } = useStore(route);
  const list = useResource<Run[]>(`/machines/${machine}/runs?limit=${MAX_RUNS}`, 15_000);
  const older = [useOlderRun(list.data, query.get("run")), useOlderRun(list.data, query.get("reference"))];
  const isPending = older.some((one) => one.isPending);
  const found = older.map((one) => one.data).filter((one) => one?.machine === machine) as Run[];
  const all = isPending ? undefined : list.data && [...list.data.filter((one) => (one.state !== "discarded" || isDwells(one)) && one.samples !== 0), ...found];
  const named = (name: string) => all?.find((one) => String(one.id) === query.get(name));
  // A run that is named but not there is not replaced by another one without a word.
  const run = query.get("run") ? named("run") : all?.find((one) => one.state === "closed");
  useEffect(() => {
    if (run && !query.get("run")) replaceQuery({ run: String(run.id) });
  }, [run?.id, query]);
  const failure = query.get("run") && all && !run ? t("noSuchRun", { run: query.get("run") }) : list.failure?.message;
  return { all, listed: list.data?.length ?? 0, run, reference: named("reference"), failure };
}

/** A run that the address names and that is too old for the list. */
function useOlderRun(listed: Run[] | undefined, id: string | null): { data: Run | undefined; isPending: boolean } {
  const path = listed && id && !listed.some((one) => String(one.id) === id) ? `/runs/${encodeURIComponent(id)}` : null;
  const { data, failure } = useResource<Run>(path);
  return { data, isPending: path !== null && !data && !failure };
}
