// A polar plot: amplitude as radius, phase lag as angle, one curve for each channel, speeds beside it.
import { useState } from "preact/hooks";
import { number, rpm } from "../format/numbers";
import { arrowStep } from "./arrow-keys";
import { niceStep } from "./axis-steps";
import { COLOURS } from "./curve-style";
import { drawnCurve, labelledPoints, nearestPlace, nextPlace, type DrawnCurve, type Point, type PointPlace, type PolarCurve } from "./polar-geometry";

const SIZE = 320;
const RADIUS = 132;

export function PolarPlot({ title, curves, unit = "µm pp" }: { title: string; curves: PolarCurve[]; unit?: string }) {
  const [place, setPlace] = useState<PointPlace | null>(null);
  const largest = Math.max(1e-9, ...curves.flatMap((one) => one.amplitude.map((value) => (value ?? 0) + (one.radius ?? 0))));
  const ring = niceStep(largest / 3);
  const rings = Math.ceil(largest / ring);
  const scale = RADIUS / (ring * rings);
  const drawn = curves.map((curve) => drawnCurve(curve, scale));
  const onPointer = (event: PointerEvent) => {
    const box = (event.currentTarget as SVGElement).getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width - 0.5) * SIZE;
    const y = ((event.clientY - box.top) / box.height - 0.5) * SIZE;
    setPlace(nearestPlace(drawn, x, y));
  };
  const onKey = (event: KeyboardEvent) => {
    const step = arrowStep(event);
    if (!step && event.key !== "Escape") return;
    event.preventDefault();
    setPlace(step && nextPlace(drawn, place, step));
  };
  const point = place && drawn[place[0]]?.points[place[1]];
  return (
    <figure class="polar">
      <figcaption>
        <strong>{title}</strong>{" "}
        <span class="muted" aria-live="polite">
          {place && point ? pointText(drawn[place[0]]!.curve, point, unit) : `rings of ${number(ring)} ${unit}`}
        </span>
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="group"
        tabindex={0}
        aria-label={`Polar plot of ${title}, largest amplitude ${number(largest)} ${unit}. Arrow keys move the read-out: left and right along a curve, up and down to another.`}
        onKeyDown={onKey}
        onPointerDown={onPointer}
        onPointerMove={onPointer}
        onPointerLeave={(event) => event.pointerType !== "touch" && setPlace(null)}
      >
        <Grid rings={rings} spacing={ring * scale} />
        {drawn.map((one) => (
          <CurveOf drawn={one} scale={scale} />
        ))}
        {point && <circle class="chosen" cx={point.x} cy={point.y} r={5} />}
      </svg>
    </figure>
  );
}

function Grid({ rings, spacing }: { rings: number; spacing: number }) {
  return (
    <>
      {Array.from({ length: rings }, (_, index) => (
        <circle class="grid" r={(index + 1) * spacing} />
      ))}
      {[0, 45, 90, 135].map((angle) => (
        <line class="grid" x1={-RADIUS} x2={RADIUS} transform={`rotate(${angle})`} />
      ))}
      {[0, 90, 180, 270].map((angle) => (
        <text x={(RADIUS + 13) * Math.cos((angle * Math.PI) / 180)} y={(RADIUS + 13) * Math.sin((angle * Math.PI) / 180) + 4} text-anchor="middle">
          {angle}°
        </text>
      ))}
    </>
  );
}

function CurveOf({ drawn: { curve, points }, scale }: { drawn: DrawnCurve; scale: number }) {
  const end = points.at(-1);
  return (
    <g class={`curve s${curve.style % COLOURS} ${curve.faint ? "faint" : ""}`}>
      {curve.line ? <path d={linePath(points)} /> : <path class="dots" d={points.map((one) => `M${one.x.toFixed(1)} ${one.y.toFixed(1)}h0`).join("")} />}
      {curve.radius !== undefined && end && <path d={circlePath(end, curve.radius * scale)} />}
      {!curve.faint && !curve.unlabelled && !curve.vector && labelledPoints(points).map((one) => (
        <text class="speed" x={one.x + 5} y={one.y - 4}>
          {Math.round(curve.rpm[one.index]!)}
        </text>
      ))}
    </g>
  );
}

function linePath(points: Point[]): string {
  return points.map((one, index) => `${index ? "L" : "M"}${one.x.toFixed(1)} ${one.y.toFixed(1)}`).join("");
}

function circlePath({ x, y }: Point, radius: number): string {
  const half = (to: number) => `A${radius.toFixed(1)} ${radius.toFixed(1)} 0 1 1 ${(x + to * radius).toFixed(1)} ${y.toFixed(1)}`;
  return `M${(x - radius).toFixed(1)} ${y.toFixed(1)}${half(1)}${half(-1)}`;
}

function pointText(curve: PolarCurve, { index }: Point, unit: string): string {
  const speed = curve.vector ? "" : `${rpm(curve.rpm[index])}, `;
  return `${curve.name}: ${speed}${number(curve.amplitude[index])} ${unit}, ${Math.round(curve.lag[index]!)}° lag`;
}
