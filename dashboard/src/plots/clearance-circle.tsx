// A bearing's clearance circle with the place where the centre of its journal rests.

/** Along one axis [m]. */
export interface Coordinate {
  value: number;
  lower: number | null;
  upper: number | null;
}

interface Props {
  label: string;
  /** Radial clearance [m]. */
  radius: number;
  /** Radial clearance between preloaded pads [m]. */
  assembled?: number | undefined;
  /** From the bearing's centre, to the right and up; null where it is not known. */
  position: { x: Coordinate; y: Coordinate } | null;
}

const SIZE = 200;
const RADIUS = 82;

export function ClearanceCircle({ label, radius, assembled, position }: Props) {
  const scale = RADIUS / radius;
  return (
    <svg viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`} role="img" aria-label={label}>
      <path class="grid" d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
      <text x={RADIUS + 5} y={3}>
        x
      </text>
      <text y={-RADIUS - 6} text-anchor="middle">
        y
      </text>
      <circle class="clearance" r={RADIUS} />
      {assembled !== undefined && <circle class="clearance assembled" r={assembled * scale} />}
      {position && <Journal x={position.x} y={position.y} scale={scale} />}
    </svg>
  );
}

/** A dot with a cross of the intervals of both coordinates, and the line of centres. */
function Journal({ x, y, scale }: { x: Coordinate; y: Coordinate; scale: number }) {
  const at = `translate(${(x.value * scale).toFixed(2)} ${(-y.value * scale).toFixed(2)})`;
  const part = (bound: number | null, of: Coordinate) => (((bound ?? of.value) - of.value) * scale).toFixed(2);
  return (
    <g class="curve s0">
      <path class="centres" d={`M0 0L${(x.value * scale).toFixed(2)} ${(-y.value * scale).toFixed(2)}`} />
      <g transform={at}>
        <path d={bar(part(x.lower, x), part(x.upper, x))} />
        <path d={bar(part(y.lower, y), part(y.upper, y))} transform="rotate(-90)" />
        <circle class="journal" r={2} />
      </g>
    </g>
  );
}

function bar(from: string, to: string): string {
  return `M${from} 0H${to}`;
}
