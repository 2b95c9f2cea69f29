// The 1× orbit of the shaft at a station.
import { number, rpm } from "../format/numbers";
import type { Orbit } from "../schemas/runs";

const STEPS = 72;
/** The dot marks the keyphasor event; the gap before it shows the direction of motion. */
const GAP = 4;
const SIZE = 200;
const RADIUS = 82;

/** ring: radius of the inner of two rings [µm]. */
export function OrbitPlot({ orbit, overlay, ring }: { orbit: Orbit; overlay: Orbit | undefined; ring: number }) {
  const scale = RADIUS / (2 * ring);
  return (
    <figure>
      <figcaption>
        <strong>{orbit.channels.join(" ")}</strong> <span class="muted">{orbit.sense}</span>
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="img"
        aria-label={`Orbit at ${orbit.channels.join(" and ")}: ${number(orbit.semi_major_um)} by ${number(Math.abs(orbit.semi_minor_um))} µm, ${orbit.sense}`}
      >
        <circle class="grid" r={RADIUS} />
        <circle class="grid" r={RADIUS / 2} />
        <path class="grid" d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
        {overlay && (
          <g class="curve faint">
            <path d={orbitPath(overlay, scale)} />
          </g>
        )}
        <g class="curve s0">
          <path d={orbitPath(orbit, scale)} />
          <circle cx={orbit.x.real_um * scale} cy={-orbit.y.real_um * scale} r={3.5} fill="currentColor" />
        </g>
      </svg>
      <p class="muted">
        {number(orbit.semi_major_um)} ± {number(2 * orbit.semi_major_error_um, 2)} by {number(Math.abs(orbit.semi_minor_um))} ±{" "}
        {number(2 * orbit.semi_minor_error_um, 2)} µm at {rpm(orbit.speed_rpm)}
        {overlay && `; overlaid run at ${rpm(overlay.speed_rpm)}`}
      </p>
    </figure>
  );
}

function orbitPath({ x, y }: Orbit, scale: number): string {
  const points = Array.from({ length: STEPS - GAP + 1 }, (_, step) => {
    const angle = (2 * Math.PI * step) / STEPS;
    const at = (phasor: { real_um: number; imaginary_um: number }) => phasor.real_um * Math.cos(angle) - phasor.imaginary_um * Math.sin(angle);
    return `${(at(x) * scale).toFixed(2)} ${(-at(y) * scale).toFixed(2)}`;
  });
  return `M${points.join("L")}`;
}
