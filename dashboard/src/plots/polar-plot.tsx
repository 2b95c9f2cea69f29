// A polar plot: amplitude as radius, phase lag as angle, one curve for each channel, speeds beside it.
import { useState } from "preact/hooks";
import { arrow, within } from "./arrow-keys";
import { number, rpm } from "../words/format";
import { STYLES } from "./plot";

export interface PolarCurve {
  name: string;
  style: number;
  rpm: number[];
  amplitude: (number | null)[];
  lag: (number | null)[];
  line: boolean;
  faint?: boolean;
  /** Without speeds beside it. */
  unlabelled?: boolean;
}

const SIZE = 320;
const RADIUS = 132;
const LABELS = 4;
/** A pointer so near to a point reads it out. */
const NEAR = 14;

interface Point {
  x: number;
  y: number;
  index: number;
}

interface Drawn {
  curve: PolarCurve;
  at: Point[];
}

/** Which is read out: the number of its curve, and its place on it. */
type Place = [number, number];

function points(curve: PolarCurve, scale: number): Point[] {
  const found: Point[] = [];
  curve.amplitude.forEach((amplitude, index) => {
    const lag = curve.lag[index];
    if (amplitude === null || lag === null || lag === undefined) return;
    const angle = (lag * Math.PI) / 180;
    // Lag grows clockwise, from 0 at the right.
    found.push({ x: amplitude * scale * Math.cos(angle), y: amplitude * scale * Math.sin(angle), index });
  });
  return found;
}

export function Polar({ title, curves, unit = "µm pp" }: { title: string; curves: PolarCurve[]; unit?: string }) {
  const [near, setNear] = useState<Place | null>(null);
  const largest = Math.max(1e-9, ...curves.flatMap((one) => one.amplitude.map((value) => value ?? 0)));
  const ring = nice(largest / 3);
  const rings = Math.ceil(largest / ring);
  const scale = RADIUS / (ring * rings);
  const drawn = curves.map((curve) => ({ curve, at: points(curve, scale) }));
  const look = (event: PointerEvent) => {
    const box = (event.currentTarget as SVGElement).getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width - 0.5) * SIZE;
    const y = ((event.clientY - box.top) / box.height - 0.5) * SIZE;
    setNear(nearest(drawn, x, y));
  };
  const keyed = (event: KeyboardEvent) => {
    const step = arrow(event);
    if (!step && event.key !== "Escape") return;
    event.preventDefault();
    setNear(step && moved(drawn, near, step));
  };
  const point = near && drawn[near[0]]?.at[near[1]];
  return (
    <figure class="polar">
      <figcaption>
        <strong>{title}</strong>{" "}
        <span class="muted" aria-live="polite">
          {near && point ? words(drawn[near[0]]!.curve, point, unit) : `rings of ${number(ring)} ${unit}`}
        </span>
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="group"
        tabindex={0}
        aria-label={`Polar plot of ${title}, largest amplitude ${number(largest)} ${unit}. Arrow keys move the read-out: left and right along a curve, up and down to another.`}
        onKeyDown={keyed}
        onPointerDown={look}
        onPointerMove={look}
        onPointerLeave={(event) => event.pointerType !== "touch" && setNear(null)}
      >
        {Array.from({ length: rings }, (_, index) => (
          <circle class="grid" r={ring * (index + 1) * scale} />
        ))}
        {[0, 45, 90, 135].map((angle) => (
          <line class="grid" x1={-RADIUS} x2={RADIUS} transform={`rotate(${angle})`} />
        ))}
        {[0, 90, 180, 270].map((angle) => (
          <text x={(RADIUS + 13) * Math.cos((angle * Math.PI) / 180)} y={(RADIUS + 13) * Math.sin((angle * Math.PI) / 180) + 4} text-anchor="middle">
            {angle}°
          </text>
        ))}
        {drawn.map(({ curve, at }) => (
          <g class={`curve s${curve.style % STYLES} ${curve.faint ? "faint" : ""}`}>
            {curve.line ? <path d={path(at)} /> : <path class="dots" d={at.map((one) => `M${one.x.toFixed(1)} ${one.y.toFixed(1)}h0`).join("")} />}
            {!curve.faint && !curve.unlabelled && speeds(curve, at)}
          </g>
        ))}
        {point && <circle class="chosen" cx={point.x} cy={point.y} r={5} />}
      </svg>
    </figure>
  );
}

function path(at: Point[]): string {
  return at.map((one, index) => `${index ? "L" : "M"}${one.x.toFixed(1)} ${one.y.toFixed(1)}`).join("");
}

/** A few speeds, well apart on the curve. */
function speeds(curve: PolarCurve, at: Point[]) {
  const shown: Point[] = [];
  for (const one of [...at].sort((a, b) => Math.hypot(b.x, b.y) - Math.hypot(a.x, a.y))) {
    if (shown.length >= LABELS) break;
    if (shown.every((other) => Math.hypot(one.x - other.x, one.y - other.y) > 46) && Math.hypot(one.x, one.y) > 40) shown.push(one);
  }
  return shown.map((one) => (
    <text class="speed" x={one.x * 1.0 + 5} y={one.y - 4}>
      {Math.round(curve.rpm[one.index]!)}
    </text>
  ));
}

function words(curve: PolarCurve, { index }: Point, unit: string): string {
  return `${curve.name}: ${rpm(curve.rpm[index])}, ${number(curve.amplitude[index])} ${unit}, ${Math.round(curve.lag[index]!)}° lag`;
}

function nearest(drawn: Drawn[], x: number, y: number): Place | null {
  let found: Place | null = null;
  let least = NEAR;
  drawn.forEach(({ at }, curve) =>
    at.forEach((one, place) => {
      const far = Math.hypot(one.x - x, one.y - y);
      if (far < least) [least, found] = [far, [curve, place]];
    }),
  );
  return found;
}

/** Along the curve, or to the point of nearest speed on another; from nowhere to the first there is. */
function moved(drawn: Drawn[], near: Place | null, [along, across]: [number, number]): Place | null {
  const filled = drawn.flatMap(({ at }, curve) => (at.length > 0 ? [curve] : []));
  const from = near && drawn[near[0]]?.at[near[1]];
  if (!near || !from) return filled.length > 0 ? [filled[0]!, 0] : null;
  if (across === 0) return [near[0], within(near[1] + along, drawn[near[0]]!.at.length)];
  const curve = filled[within(filled.indexOf(near[0]) + Math.sign(across), filled.length)]!;
  return curve === near[0] ? near : [curve, ofSpeed(drawn[curve]!, drawn[near[0]]!.curve.rpm[from.index]!)];
}

function ofSpeed({ curve, at }: Drawn, speed: number): number {
  const far = at.map((one) => Math.abs(curve.rpm[one.index]! - speed));
  return far.indexOf(Math.min(...far));
}

/** The next of 1, 2, 5 times a power of ten. */
export function nice(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value * 0.999) ?? 10 * power;
}
