// Fields to choose a run, and one to overlay on it.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { MAX_RUNS, type RunSelection } from "../data/run-selection";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import type { Run } from "../schemas/runs";
import { Truncated } from "./panel";

export function RunSelect({ all, listed, run, reference }: RunSelection) {
  const asked = useStore(route).query.get("reference");
  const sameKind = all?.filter((one) => one.kind === run?.kind && one.id !== run?.id) ?? [];
  return (
    <>
      <label>
        {t("run")}
        <select value={run?.id ?? ""} onChange={(event) => replaceQuery({ run: event.currentTarget.value, reference: null })}>
          {!run && <option value="">{t("none")}</option>}
          <Options runs={all ?? []} />
        </select>
      </label>
      <OverlaySelect runs={sameKind} chosen={reference} />
      <Truncated shown={listed} limit={MAX_RUNS} of={t("runs")} />
      <button type="button" disabled={sameKind.length === 0} onClick={() => replaceQuery({ reference: String(sameKind.at(-1)!.id) })}>
        {t("overlayTheOldestOfIts")}
      </button>
      {all && asked && !reference && <NotOverlaid>{t("overlaidRunIsNotHere", { id: asked })}</NotOverlaid>}
    </>
  );
}

/** Why a run that was chosen is not laid over; nothing where it is. */
export function NotOverlaid({ children }: { children: string | undefined }) {
  return children ? (
    <p class="error" role="status">
      {children}
    </p>
  ) : null;
}

/** A field to choose the run that is overlaid, which the address names. */
export function OverlaySelect({ runs, chosen }: { runs: Run[]; chosen: Run | undefined }) {
  return (
    <label>
      {t("overlay")}
      <select value={chosen?.id ?? ""} onChange={(event) => replaceQuery({ reference: event.currentTarget.value || null })}>
        <option value="">{t("none")}</option>
        <Options runs={runs} />
      </select>
    </label>
  );
}

function Options({ runs }: { runs: Run[] }) {
  return (
    <>
      {runs.map((one) => (
        <option key={one.id} value={one.id}>
          {`${one.id}  ${term(one.kind)}, ${when(one.started_at)}${one.state === "open" ? t("openInBrackets") : ""}`}
        </option>
      ))}
    </>
  );
}
