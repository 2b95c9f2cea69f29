// The run that is being collected, drawn while it grows, over an earlier one of its kind where one is chosen.
import { route } from "../browser/router";
import { useStore } from "../browser/store";
import { inUnit, speedsInUnit, useUnits, type Units } from "../browser/units";
import { ErrorMessage, Loading, StaleNotice } from "../components/loading";
import { Panel } from "../components/panel";
import { NotOverlaid, OverlaySelect } from "../components/run-select";
import { useResource, type QueryResult } from "../data/resource";
import { MAX_RUNS } from "../data/run-selection";
import { speedSweep, type SpeedSweep } from "../data/speed-sweep";
import { t, term } from "../messages/messages";
import { mergeOnCommonAxis } from "../plots/common-axis";
import { Plot } from "../plots/plot";
import type { Curve } from "../plots/plot-props";
import type { Column } from "../schemas/columns";
import type { Document, MachineState } from "../schemas/machines";
import type { Phasors, Run } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

const POLL_MS = 1500;
const LIST_MS = 15_000;

export function LiveRunPanel({ machine }: { machine: Document }) {
  const run = useResource<MachineState>(`/machines/${machine.id}/state`).data?.run;
  const result = useResource<Phasors>(run ? `/runs/${run.id}/phasors?slow_roll=in_force` : null, POLL_MS);
  const { query } = useStore(route);
  const list = useResource<Run[]>(run ? `/machines/${machine.id}/runs?limit=${MAX_RUNS}` : null, LIST_MS);
  const earlier = (list.data ?? []).filter((one) => one.kind === run?.kind && one.id !== run.id && one.state !== "discarded" && one.samples !== 0);
  const asked = query.get("reference");
  const chosen = earlier.find((one) => String(one.id) === asked);
  const overlaid = useResource<Phasors>(chosen ? `/runs/${chosen.id}/phasors?slow_roll=in_force` : null);
  const units = useUnits();
  if (!run) return null;
  const { amplitude, speed } = units;
  const phasors = result.data;
  const sweep = phasors && speedSweep(phasors);
  const aside = (
    <>
      {phasors && (
        <p class="muted">
          {[chosen && overlaid.data && t("overlaidRunLegend", { of: "" }), slowRollOf(phasors)].filter(Boolean).join("; ")}
        </p>
      )}
      {earlier.length > 0 && (
        <div class="choices">
          <OverlaySelect runs={earlier} chosen={chosen} />
        </div>
      )}
    </>
  );
  return (
    <Panel title={t("runLive", { id: run.id })} class="live" aside={aside}>
      <StaleNotice result={result} />
      {list.failure?.isLocal && <ErrorMessage failure={list.failure} />}
      {list.data && asked && !chosen && <NotOverlaid>{t("overlaidRunIsNone", { id: asked, kind: term(run.kind) })}</NotOverlaid>}
      {chosen && <NotOverlaid>{whyMissing(chosen, overlaid, phasors)}</NotOverlaid>}
      {sweep ? (
        <Plot
          label={t("amplitudeSoFar", { id: run.id })}
          xUnit={speed.label}
          yUnit={amplitude.label}
          {...curvesOf(sweep, overlaid.data && speedSweep(overlaid.data), units)}
          xRange={[machine.speed_range.minimum_rpm * speed.factor, machine.speed_range.maximum_rpm * speed.factor]}
          height={190}
        />
      ) : (
        <Loading height="190px" />
      )}
    </Panel>
  );
}

/** Why a run is not drawn over another one: it cannot be read, or has no values of that one's channels; nothing where it is drawn. */
function whyMissing({ id }: Run, { data, failure }: QueryResult<Phasors>, over: Phasors | undefined): string | undefined {
  if (!data) return failure && t("overlaidRunCannotBeRead", { id, reason: failure.message });
  if (data.speed_rpm.length === 0) return t("overlaidRunIsEmpty", { id });
  return over && !over.channels.some((one) => data.channels.includes(one)) ? t("overlaidRunHasOtherChannels", { id }) : undefined;
}

/** The amplitudes of a run's channels, and behind them those of an overlaid one. */
function curvesOf(sweep: SpeedSweep, overlaid: SpeedSweep | undefined, { amplitude, speed }: Units): { x: number[]; curves: Curve[] } {
  const found = overlaid ? sweep.channels.map((channel) => overlaid.amplitude[overlaid.channels.indexOf(channel)] ?? []) : [];
  const behind = { x: speedsInUnit(overlaid?.rpm ?? [], speed), columns: found.map((one) => inUnit(one, amplitude)) };
  const measured = { x: speedsInUnit(sweep.rpm, speed), columns: sweep.amplitude.map((one) => inUnit(one, amplitude)) };
  const { x, columns } = mergeOnCommonAxis([behind, measured]);
  const [before, now] = columns as [Column[], Column[]];
  return {
    x,
    curves: [
      ...before.map((y, at): Curve => ({ name: t("overlaidRun", { channel: sweep.channels[at]! }), style: at, y, faint: true, points: true, line: false })),
      ...now.map((y, style): Curve => ({ name: sweep.channels[style]!, style, y, points: true, spanGaps: true })),
    ],
  };
}

function slowRollOf({ slow_roll_version: version, slow_roll_left_out: leftOut }: Phasors): string {
  return slowRollText(version, Object.keys(leftOut));
}
