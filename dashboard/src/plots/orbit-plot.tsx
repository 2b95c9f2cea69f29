// The orbit of the shaft at a station in one turn, from 1× and where it is sent 2×, with its probes and their timebase.
import type { DataColumn } from "../browser/download";
import { number } from "../format/numbers";
import { t, term } from "../messages/messages";
import type { AxisPhasor, Orbit } from "../schemas/runs";
import { SaveDrawing } from "./save-buttons";

const STEPS = 144;
/** The dot marks the keyphasor event; the gap before it shows the direction of motion. */
const GAP = 6;
const SIZE = 200;
const RADIUS = 78;
const PROBE_RADIUS = 91;
/** Characters of a name that fits beside its probe; longer ones stand in the corners below the rings, clear of the orbit. */
const SHORT_NAME = 5;
const CORNER_NAME = 16;
const BASE_WIDTH = 200;
const BASE_HEIGHT = 70;
/** Factor from 0-to-peak to peak-to-peak. */
const PEAK_TO_PEAK = 2;

interface Props {
  orbit: Orbit;
  overlay: Orbit | undefined;
  /** Radius of the inner of two rings, peak-to-peak [µm]. */
  ring: number;
  second: boolean;
  unit: { label: string; factor: number };
  speed: (rpm: number) => string;
}

export function OrbitPlot({ orbit, overlay, ring, second, unit, speed }: Props) {
  const scale = (PEAK_TO_PEAK * RADIUS) / (2 * ring);
  const label = t("orbitAt", { channels: orbit.channels.join(t("and")) });
  const lengthText = (value: number, digits = 3) => number(PEAK_TO_PEAK * value * unit.factor, digits);
  const [x, y] = motion(orbit, second);
  return (
    <figure>
      <figcaption>
        <strong>{orbit.channels.join(" ")}</strong> <span class="muted">{term(orbit.sense)}</span>
        <SaveDrawing label={label} columns={() => columnsOf(orbit, second)} />
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE + BASE_HEIGHT}`}
        role="img"
        aria-label={t("orbitLabel", { label, major: lengthText(orbit.semi_major_um), minor: lengthText(Math.abs(orbit.semi_minor_um)), unit: unit.label, sense: term(orbit.sense) })}
      >
        <circle class="grid" r={RADIUS} />
        <circle class="grid" r={RADIUS / 2} />
        <path class="grid" d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
        <ProbeDirections orbit={orbit} />
        {overlay && (
          <g class="curve faint">
            <path d={orbitPath(motion(overlay, second), scale)} />
          </g>
        )}
        <g class="curve s0">
          <path d={orbitPath([x, y], scale)} />
          <circle cx={x[0]! * scale} cy={-y[0]! * scale} r={3.5} fill="currentColor" />
        </g>
        <Timebase orbit={orbit} second={second} scale={(BASE_HEIGHT / 2 - 8) / RADIUS * scale} />
      </svg>
      <p class="muted">
        {t("orbitText", { major: lengthText(orbit.semi_major_um), major_error: lengthText(2 * orbit.semi_major_error_um, 2), minor: lengthText(Math.abs(orbit.semi_minor_um)), minor_error: lengthText(2 * orbit.semi_minor_error_um, 2), unit: unit.label, speed: speed(orbit.speed_rpm), second: second && !orbit.x_2x && t("no2IsSentHere"), overlay: overlay && t("overlaidAt", { speed: speed(overlay.speed_rpm) }) })}
      </p>
    </figure>
  );
}

function at(phasor: AxisPhasor | null, angle: number): number {
  return phasor ? phasor.real_um * Math.cos(angle) - phasor.imaginary_um * Math.sin(angle) : 0;
}

/** Displacements along x and y over one turn, 0-to-peak [µm]. */
function motion(orbit: Orbit, second: boolean): [number[], number[]] {
  const angles = Array.from({ length: STEPS }, (_, step) => (2 * Math.PI * step) / STEPS);
  const along = (first: AxisPhasor, twice: AxisPhasor | null) => angles.map((angle) => at(first, angle) + (second ? at(twice, 2 * angle) : 0));
  return [along(orbit.x, orbit.x_2x), along(orbit.y, orbit.y_2x)];
}

function orbitPath([x, y]: [number[], number[]], scale: number): string {
  const points = x.slice(0, STEPS - GAP + 1).map((one, step) => `${(one * scale).toFixed(2)} ${(-y[step]! * scale).toFixed(2)}`);
  return `M${points.join("L")}`;
}

/** Each probe where it looks at the shaft from. */
function ProbeDirections({ orbit }: { orbit: Orbit }) {
  const areShort = orbit.channels.every((one) => one.length <= SHORT_NAME);
  return (
    <>
      {orbit.channels.map((channel, index) => {
        const angle = orbit.angles_deg[index]!;
        const [x, y] = [Math.cos((angle * Math.PI) / 180), -Math.sin((angle * Math.PI) / 180)];
        return (
          <g key={channel} class={`curve s${index}`}>
            <path transform={`translate(${(RADIUS * x).toFixed(1)} ${(RADIUS * y).toFixed(1)}) rotate(${-angle})`} d="M2 -4H9V4H2Z" />
            {areShort ? (
              <text x={PROBE_RADIUS * x} y={PROBE_RADIUS * y + (Math.abs(y) < 0.3 ? -8 : y > 0 ? 6 : 1)} text-anchor={x > 0.3 ? "end" : x < -0.3 ? "start" : "middle"}>
                {channel}
              </text>
            ) : (
              <text class="corner" x={(SIZE / 2 - 2) * (index ? 1 : -1)} y={SIZE / 2 + 2} text-anchor={index ? "end" : "start"}>
                {shortened(channel)}
                <title>{channel}</title>
              </text>
            )}
          </g>
        );
      })}
    </>
  );
}

/** The end of a long name, in which those of one station differ. */
function shortened(name: string): string {
  return name.length <= CORNER_NAME ? name : `…${name.slice(1 - CORNER_NAME)}`;
}

/** What a probe sees along its own direction over one turn, 0-to-peak [µm]. */
function seen(orbit: Orbit, second: boolean, index: number): number[] {
  const angle = (orbit.angles_deg[index]! * Math.PI) / 180;
  const [x, y] = motion(orbit, second);
  return x.map((one, step) => one * Math.cos(angle) + y[step]! * Math.sin(angle));
}

/** The signals of the probes over one turn from the keyphasor event. */
function Timebase({ orbit, second, scale }: { orbit: Orbit; second: boolean; scale: number }) {
  const middle = SIZE / 2 + BASE_HEIGHT / 2 - 4;
  const path = (values: number[]) =>
    `M${[...values, values[0]!].map((one, step) => `${((step / STEPS - 0.5) * BASE_WIDTH * 0.9).toFixed(2)} ${(middle - one * scale).toFixed(2)}`).join("L")}`;
  return (
    <>
      <path class="grid" d={`M${-0.45 * BASE_WIDTH} ${middle}H${0.45 * BASE_WIDTH}M${-0.45 * BASE_WIDTH} ${middle - 26}V${middle + 26}`} />
      {orbit.channels.map((channel, index) => (
        <g key={channel} class={`curve s${index}`}>
          <path d={path(seen(orbit, second, index))} />
        </g>
      ))}
    </>
  );
}

function columnsOf(orbit: Orbit, second: boolean): DataColumn[] {
  const [x, y] = motion(orbit, second);
  return [
    { name: t("turn"), values: x.map((_, step) => (360 * step) / STEPS) },
    { name: t("x0ToPeakM"), values: x },
    { name: t("y0ToPeakM"), values: y },
    ...orbit.channels.map((channel, index) => ({ name: t("channelPeak", { channel }), values: seen(orbit, second, index) })),
  ];
}
