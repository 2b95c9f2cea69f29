// The angle of a vector over time: a change of it alone does not show in the magnitude.
import { ANY_ANGLE } from "../format/angles";
import { t } from "../messages/messages";
import { unwrapPhase } from "../plots/phase";
import { Plot } from "../plots/plot";
import type { Curve, Marker } from "../plots/plot-props";
import { curveName, overAll, seconds, type HistoryPoint, type MachineHistory } from "./history-points";

interface Props {
  histories: MachineHistory[];
  points: HistoryPoint[];
  kinds: string[];
  markers: Marker[];
  xRange: [number, number] | undefined;
  readOut: (index: number) => string;
  onPick: (index: number) => void;
}

export function AngleHistoryPlot({ histories, points, kinds, markers, xRange, readOut, onPick }: Props) {
  const { series } = histories[0]!;
  const isThinned = series.down_sampling && series.down_sampling.method !== "none";
  return (
    <>
      {isThinned && (
        <p class="muted thinned">{t("thinnedAngles", { points: series.down_sampling!.points })}</p>
      )}
      <Plot
        label={t("angleOverTime", { parameter: series.parameter, points: points.length })}
        x={points.map(seconds)}
        time
        yUnit={t("angleInDegrees")}
        curves={histories.flatMap((one, place) => angleCurves(one, kinds, place * kinds.length).map((curve) => overAll(curve, one, points)))}
        markers={markers}
        {...(xRange ? { xRange } : {})}
        syncGroup="trends"
        height={130}
        readOut={readOut}
        onPick={onPick}
      />
    </>
  );
}

/** A curve for each kind of run, of accepted identifications only, in colours from a number on. */
function angleCurves(history: MachineHistory, kinds: string[], colour: number): Curve[] {
  const { series } = history;
  const accepted = series.quality.map((one) => one === "accepted");
  const angles = unwrapPhase(series.measured_at.map((_, at) => (accepted[at] ? series.angle_deg?.[at] ?? null : null)));
  return kinds.map((kind, place): Curve => {
    const y = angles.map((one, at) => (series.run_kind[at] === kind ? one : null));
    const bound = (sign: number) =>
      y.map((one, at) => {
        const half = series.angle_half_width_deg?.[at] ?? ANY_ANGLE;
        return one === null || half >= ANY_ANGLE ? null : one + sign * half;
      });
    return { name: curveName(history, kind), style: colour + place, y, lower: bound(-1), upper: bound(1), points: true, spanGaps: true };
  });
}
