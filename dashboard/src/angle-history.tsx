// The angle of a vector over time: a change of it alone does not show in the magnitude.
import type { Series } from "./answers";
import { unwrapped } from "./common-axis";
import { Plot, type Curve, type Marker } from "./plot";

/** Degrees, in the rotor's frame as the service gives real and imaginary part; null for what is no vector or not known. */
export function angleAt(series: Series, index: number): number | null {
  const [real, imaginary] = [series.real?.[index] ?? null, series.imaginary?.[index] ?? null];
  return real === null || imaginary === null ? null : (Math.atan2(imaginary, real) * 180) / Math.PI;
}

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
  const angles = unwrapped(series.measured_at.map((_, at) => (accepted[at] ? angleAt(series, at) : null)));
  const curves = kinds.map((name, style): Curve => ({ name, style, y: angles.map((one, at) => (series.run_kind[at] === name ? one : null)), points: true, spans: true }));
  return (
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
  );
}
