// The angle of a vector over time: a change of it alone does not show in the magnitude.
import { ANY_ANGLE } from "../format/angles";
import { t, term } from "../messages/messages";
import { unwrapPhase } from "../plots/phase";
import { Plot } from "../plots/plot";
import type { Curve, Marker } from "../plots/plot-props";
import type { Series } from "../schemas/trends";

interface Props {
  series: Series;
  kinds: string[];
  markers: Marker[];
  xRange: [number, number] | undefined;
  readOut: (index: number) => string;
  onPick: (index: number) => void;
}

export function AngleHistoryPlot({ series, kinds, markers, xRange, readOut, onPick }: Props) {
  const isThinned = series.down_sampling && series.down_sampling.method !== "none";
  return (
    <>
      {isThinned && (
        <p class="muted thinned">{t("thinnedAngles", { points: series.down_sampling!.points })}</p>
      )}
      <Plot
        label={t("angleOverTime", { parameter: series.parameter, points: series.value.length })}
        x={series.measured_at.map((one) => Date.parse(one) / 1000)}
        time
        yUnit="angle, °"
        curves={angleCurves(series, kinds)}
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

/** A curve for each kind of run, of accepted identifications only. */
function angleCurves(series: Series, kinds: string[]): Curve[] {
  const accepted = series.quality.map((one) => one === "accepted");
  const angles = unwrapPhase(series.measured_at.map((_, at) => (accepted[at] ? series.angle_deg?.[at] ?? null : null)));
  return kinds.map((kind, style): Curve => {
    const y = angles.map((one, at) => (series.run_kind[at] === kind ? one : null));
    const bound = (sign: number) =>
      y.map((one, at) => {
        const half = series.angle_half_width_deg?.[at] ?? ANY_ANGLE;
        return one === null || half >= ANY_ANGLE ? null : one + sign * half;
      });
    return { name: term(kind), style, y, lower: bound(-1), upper: bound(1), points: true, spanGaps: true };
  });
}
