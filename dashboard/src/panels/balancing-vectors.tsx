// Vector plots of a balancing: of each channel the point where it moves most, from run to run to the prediction and the check.
import { useUnits, type Unit } from "../browser/units";
import { t } from "../messages/messages";
import { CurveLegend } from "../plots/curve-legend";
import type { PolarCurve } from "../plots/polar-geometry";
import { PolarPlot } from "../plots/polar-plot";
import type { CheckRun, PointVectors, ProposedCorrection, Vector } from "../schemas/balancings";

const PREDICTED = t("predictedWithIts95Circle");

export function BalancingVectors({ correction, check }: { correction: ProposedCorrection; check: CheckRun | null }) {
  const { amplitude } = useUnits();
  const largest = new Map<string, PointVectors>();
  for (const one of correction.vectors) {
    const other = largest.get(one.channel);
    if (!other || initialSize(one) > initialSize(other)) largest.set(one.channel, one);
  }
  const runs = new Set(correction.vectors.flatMap((one) => one.runs.map((run) => run.name)));
  const names = [...runs, PREDICTED, ...(check ? [checkName(check)] : [])];
  return (
    <>
      <p class="muted">{t("phaseLagIncreasesClockwiseFrom")}</p>
      <CurveLegend curves={names.map((name, style) => ({ name, style }))} />
      <div class="polars">
        {[...largest.values()].map((one) => (
          <PolarPlot key={one.point} title={one.point} curves={vectorsOf(one, check, names, amplitude)} unit={amplitude.label} />
        ))}
      </div>
    </>
  );
}

function checkName(check: CheckRun): string {
  return t("checkRunNumber", { run: check.run });
}

function initialSize(one: PointVectors): number {
  return one.runs[0]?.amplitude_um_pp ?? 0;
}

function vectorsOf(one: PointVectors, check: CheckRun | null, names: string[], { factor }: Unit): PolarCurve[] {
  const measured = check?.vectors.find((vector) => vector.point === one.point);
  return [
    ...one.runs.map((run) => arrow(run.name, names, run, factor)),
    { ...arrow(PREDICTED, names, one.predicted, factor), radius: one.radius_um_pp * factor },
    ...(check && measured ? [arrow(checkName(check), names, measured, factor)] : []),
  ];
}

/** A vector as a line from the middle of the plot. */
function arrow(name: string, names: string[], { amplitude_um_pp, lag_deg }: Vector, factor: number): PolarCurve {
  const style = names.indexOf(name);
  return { name, style, rpm: [0, 0], amplitude: [0, amplitude_um_pp * factor], lag: [lag_deg, lag_deg], line: true, vector: true };
}
