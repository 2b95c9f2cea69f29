// Fields to choose a run, and one to overlay on it.
import { replaceQuery } from "../browser/router";
import { MAX_RUNS, type RunSelection } from "../data/run-selection";
import { when } from "../format/times";
import type { Run } from "../schemas/runs";
import { Truncated } from "./panel";

export function RunSelect({ all, listed, run, reference }: RunSelection) {
  const sameKind = all?.filter((one) => one.kind === run?.kind && one.id !== run?.id) ?? [];
  return (
    <>
      <label>
        Run
        <select value={run?.id ?? ""} onChange={(event) => replaceQuery({ run: event.currentTarget.value, reference: null })}>
          {!run && <option value="">none</option>}
          <Options runs={all ?? []} />
        </select>
      </label>
      <label>
        Overlay
        <select value={reference?.id ?? ""} onChange={(event) => replaceQuery({ reference: event.currentTarget.value || null })}>
          <option value="">none</option>
          <Options runs={sameKind} />
        </select>
      </label>
      <Truncated shown={listed} limit={MAX_RUNS} of="runs" />
      {sameKind.length > 0 && (
        <button type="button" onClick={() => replaceQuery({ reference: String(sameKind.at(-1)!.id) })}>
          Overlay the oldest of its kind
        </button>
      )}
    </>
  );
}

function Options({ runs }: { runs: Run[] }) {
  return (
    <>
      {runs.map((one) => (
        <option key={one.id} value={one.id}>
          {`${one.id}  ${one.kind}, ${when(one.started_at)}${one.state === "open" ? " (open)" : ""}`}
        </option>
      ))}
    </>
  );
}
