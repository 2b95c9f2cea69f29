// Vector plots of a balancing: of each channel the point where it moves most, from run to run to the prediction and the check.
import type { PolarCurve } from "../plots/polar-geometry";
import { PolarPlot } from "../plots/polar-plot";
import type { CheckRun, PointVectors, ProposedCorrection, Vector } from "../schemas/balancings";

export function BalancingVectors({ correction, check }: { correction: ProposedCorrection; check: CheckRun | null }) {
  const largest = new Map<string, PointVectors>();
  for (const one of correction.vectors) {
    const other = largest.get(one.channel);
    if (!other || initialSize(one) > initialSize(other)) largest.set(one.channel, one);
  }
  return (
    <div class="polars">
      {[...largest.values()].map((one) => (
        <PolarPlot key={one.point} title={one.point} curves={vectorsOf(one, check)} />
      ))}
    </div>
  );
}

function initialSize(one: PointVectors): number {
  return one.runs[0]?.amplitude_um_pp ?? 0;
}

function vectorsOf(one: PointVectors, check: CheckRun | null): PolarCurve[] {
  const measured = check?.vectors.find((vector) => vector.point === one.point);
  return [
    ...one.runs.map((run, style) => arrow(run.name, style, run)),
    { ...arrow("predicted", one.runs.length, one.predicted), radius: one.radius_um_pp },
    ...(check && measured ? [arrow(`check run ${check.run}`, one.runs.length + 1, measured)] : []),
  ];
}

/** A vector as a line from the middle of the plot. */
function arrow(name: string, style: number, { amplitude_um_pp, lag_deg }: Vector): PolarCurve {
  return { name, style, rpm: [0, 0], amplitude: [0, amplitude_um_pp], lag: [lag_deg, lag_deg], line: true, named: true };
}
