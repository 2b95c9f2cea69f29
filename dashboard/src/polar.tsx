// A polar plot: amplitude as radius, phase lag as angle, one curve for each channel, speeds beside it.
import { useState } from "preact/hooks";
import { number, rpm } from "./format";
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

interface Point {
  x: number;
  y: number;
  index: number;
}

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
  const [near, setNear] = useState<string | null>(null);
  const largest = Math.max(1e-9, ...curves.flatMap((one) => one.amplitude.map((value) => value ?? 0)));
  const ring = nice(largest / 3);
  const rings = Math.ceil(largest / ring);
  const scale = RADIUS / (ring * rings);
  const drawn = curves.map((curve) => ({ curve, at: points(curve, scale) }));
  const look = (event: PointerEvent) => {
    const box = (event.currentTarget as SVGElement).getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width - 0.5) * SIZE;
    const y = ((event.clientY - box.top) / box.height - 0.5) * SIZE;
    setNear(nearest(drawn, x, y, unit));
  };
  return (
    <figure class="polar">
      <figcaption>
        <strong>{title}</strong> <span class="muted">{near ?? `rings of ${number(ring)} ${unit}`}</span>
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="img"
        aria-label={`Polar plot of ${title}, largest amplitude ${number(largest)} ${unit}`}
        onPointerMove={look}
        onPointerLeave={() => setNear(null)}
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

function nearest(drawn: { curve: PolarCurve; at: Point[] }[], x: number, y: number, unit: string): string | null {
  let best: { far: number; words: string } | null = null;
  for (const { curve, at } of drawn) {
    for (const one of at) {
      const far = Math.hypot(one.x - x, one.y - y);
      if (far < 14 && (!best || far < best.far)) {
        const amplitude = number(curve.amplitude[one.index]);
        best = { far, words: `${curve.name}: ${rpm(curve.rpm[one.index])}, ${amplitude} ${unit}, ${Math.round(curve.lag[one.index]!)}° lag` };
      }
    }
  }
  return best?.words ?? null;
}

/** The next of 1, 2, 5 times a power of ten. */
export function nice(value: number): number {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].map((step) => step * power).find((step) => step >= value * 0.999) ?? 10 * power;
}
