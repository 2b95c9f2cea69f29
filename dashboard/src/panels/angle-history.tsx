// The angle of a vector over time: a change of it alone does not show in the magnitude.
import type { Series } from "../schemas/answers";
import { unwrapped } from "../plots/common-axis";
import { number } from "../words/format";
import { Plot, type Curve, type Marker } from "../plots/plot";

/** From the keyphasor mark on, with its 95 % interval; nothing for what is no vector or not known. */
export function angleWords(angle: number | null, halfWidth: number | null): string {
  if (angle === null || halfWidth === null) return "";
  return halfWidth < ANY ? ` at ${angle.toFixed(1)}° ± ${number(halfWidth, 2)}°` : " at any angle";
}

/** Half an interval that leaves every angle open [°]. */
const ANY = 180;

interface Props {
  series: Series;
  kinds: string[];
  markers: Marker[];
  xRange: [number, number] | undefined;
  readOut: (index: number) => string;
  onPick: (index: number) => void;
}

export function AngleHistory({ series, kinds, markers, xRange, readOut, onPick }: Props) {
  const accepted = series.quality.map((one) => one === "accepted");
  const angles = unwrapped(series.measured_at.map((_, at) => (accepted[at] ? series.angle_deg?.[at] ?? null : null)));
  const curves = kinds.map((name, style): Curve => {
    const y = angles.map((one, at) => (series.run_kind[at] === name ? one : null));
    const bound = (sign: number) =>
      y.map((one, at) => {
        const half = series.angle_half_width_deg?.[at] ?? ANY;
        return one === null || half >= ANY ? null : one + sign * half;
      });
    return { name, style, y, lower: bound(-1), upper: bound(1), points: true, spans: true };
  });
  const thinned = series.down_sampling && series.down_sampling.method !== "none";
  return (
    <>
      {thinned && (
        <p class="muted thinned">at the lowest and highest of each stretch, of {series.down_sampling!.points} points</p>
      )}
      <Plot
        label={`Angle of ${series.parameter} over time, ${series.value.length} points`}
        x={series.measured_at.map((one) => Date.parse(one) / 1000)}
        time
        yUnit="angle, °"
        curves={curves}
        markers={markers}
        {...(xRange ? { xRange } : {})}
        together="trends"
        height={130}
        readOut={readOut}
        onPick={onPick}
      />
    </>
  );
}
