// The geometry of a polar plot: points on the screen, the one nearest to the pointer, and the next one by keys.
import { clampIndex } from "./arrow-keys";

export interface PolarCurve {
  name: string;
  style: number;
  rpm: number[];
  amplitude: (number | null)[];
  lag: (number | null)[];
  line: boolean;
  /** Its points are marked on the line as well. */
  marked?: boolean;
  faint?: boolean;
  /** Without speeds beside it. */
  unlabelled?: boolean;
  /** A vector from the middle to its last point: no speeds stand beside it or in its read-out. */
  vector?: boolean;
  /** Radius of the circle around the last point in which it lies with 95 %. */
  radius?: number;
  /** A region around a centre in which the next point lies with 95 %, in the plane of real part and imaginary part upwards. */
  region?: { real: number; imaginary: number; semiMajor: number; semiMinor: number; inclinationDeg: number };
}

export interface Point {
  x: number;
  y: number;
  index: number;
}

export interface DrawnCurve {
  curve: PolarCurve;
  points: Point[];
}

/** A point that is read out: the number of its curve, and its place on it. */
export type PointPlace = [number, number];

/** A pointer this near to a point reads it out. */
const NEAR = 14;
const LABELS = 4;
const LABEL_DISTANCE = 46;
const LABEL_RADIUS = 40;

export function drawnCurve(curve: PolarCurve, scale: number): DrawnCurve {
  const points: Point[] = [];
  curve.amplitude.forEach((amplitude, index) => {
    const lag = curve.lag[index];
    if (amplitude === null || lag === null || lag === undefined) return;
    const angle = (lag * Math.PI) / 180;
    // Lag increases clockwise, from 0 at the right.
    points.push({ x: amplitude * scale * Math.cos(angle), y: amplitude * scale * Math.sin(angle), index });
  });
  return { curve, points };
}

/** A few points of each curve whose speeds are written beside them, well apart from each other and from those of other curves. */
export function labelledPoints(drawn: DrawnCurve[]): Point[][] {
  const placed: Point[] = [];
  return drawn.map(({ curve, points }) => {
    if (curve.faint || curve.unlabelled || curve.vector) return [];
    const labelled: Point[] = [];
    for (const one of [...points].sort((a, b) => Math.hypot(b.x, b.y) - Math.hypot(a.x, a.y))) {
      if (labelled.length >= LABELS || Math.hypot(one.x, one.y) <= LABEL_RADIUS) break;
      if (placed.some((other) => Math.hypot(one.x - other.x, one.y - other.y) <= LABEL_DISTANCE)) continue;
      labelled.push(one);
      placed.push(one);
    }
    return labelled;
  });
}

export function nearestPlace(drawn: DrawnCurve[], x: number, y: number): PointPlace | null {
  let found: PointPlace | null = null;
  let least = NEAR;
  drawn.forEach(({ points }, curve) =>
    points.forEach((one, place) => {
      const distance = Math.hypot(one.x - x, one.y - y);
      if (distance < least) [least, found] = [distance, [curve, place]];
    }),
  );
  return found;
}

/** The next place along the curve, or at the nearest speed of the next curve; from nowhere the first there is. */
export function nextPlace(drawn: DrawnCurve[], place: PointPlace | null, [along, across]: [number, number]): PointPlace | null {
  const filled = drawn.flatMap(({ points }, curve) => (points.length > 0 ? [curve] : []));
  const from = place && drawn[place[0]]?.points[place[1]];
  if (!place || !from) return filled.length > 0 ? [filled[0]!, 0] : null;
  if (across === 0) return [place[0], clampIndex(place[1] + along, drawn[place[0]]!.points.length)];
  const curve = filled[clampIndex(filled.indexOf(place[0]) + Math.sign(across), filled.length)]!;
  return curve === place[0] ? place : [curve, placeOfSpeed(drawn[curve]!, drawn[place[0]]!.curve.rpm[from.index]!)];
}

function placeOfSpeed({ curve, points }: DrawnCurve, speed: number): number {
  const distances = points.map((one) => Math.abs(curve.rpm[one.index]! - speed));
  return distances.indexOf(Math.min(...distances));
}
