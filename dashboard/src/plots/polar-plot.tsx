// A polar plot: amplitude as radius, phase lag as angle, one curve for each channel, speeds beside it.
import { useState } from "preact/hooks";
import { number, rpm } from "../format/numbers";
import type { DataColumn } from "../browser/download";
import { t } from "../messages/messages";
import { arrowStep } from "./arrow-keys";
import { niceStep } from "./axis-steps";
import { COLOURS } from "./curve-style";
import { withinTurn } from "./read-out";
import { SaveDrawing } from "./save-buttons";
import { drawnCurve, labelledPoints, nearestPlace, nextPlace, type DrawnCurve, type Point, type PointPlace, type PolarCurve } from "./polar-geometry";

const SIZE = 320;
const RADIUS = 132;
/** Distance of a speed's text from its point. */
const SPEED_APART = 7;
/** Width of a speed's text; where there is less room it stands inwards. */
const SPEED_WIDTH = 28;

interface Props {
  title: string;
  curves: PolarCurve[];
  unit: string;
  /** Unit of the speeds beside the curves. */
  speedUnit?: string;
}

export function PolarPlot({ title, curves, unit, speedUnit = t("rpm") }: Props) {
  const [place, setPlace] = useState<PointPlace | null>(null);
  const largest = Math.max(1e-9, ...curves.flatMap((one) => [...one.amplitude.map((value) => (value ?? 0) + (one.radius ?? 0)), regionReach(one)]));
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
          {place && point ? pointText(drawn[place[0]]!.curve, point, unit, speedUnit) : t("ringsOf", { ring: number(ring), unit })}
        </span>
        <SaveDrawing label={t("polarPlotOf", { title })} columns={() => columnsOf(curves, unit)} />
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="group"
        tabindex={0}
        aria-label={t("polarKeys", { title, largest: number(largest), unit })}
        onKeyDown={onKey}
        onPointerDown={onPointer}
        onPointerMove={onPointer}
        onPointerLeave={(event) => event.pointerType !== "touch" && setPlace(null)}
      >
        <Grid rings={rings} spacing={ring * scale} />
        {drawn.map((one) => (
          <CurveOf drawn={one} scale={scale} />
        ))}
        {labelledPoints(drawn).map((points, at) => (
          <SpeedsAt points={points} curve={drawn[at]!.curve} />
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
      {curve.line && <path d={linePath(points)} />}
      {(!curve.line || curve.marked) && <path class="dots" d={points.map((one) => `M${one.x.toFixed(1)} ${one.y.toFixed(1)}h0`).join("")} />}
      {curve.region && <path class="region" d={regionPath(curve.region, scale)} />}
      {curve.radius !== undefined && end && <path d={circlePath(end, curve.radius * scale)} />}
    </g>
  );
}

/** Speeds beside a curve, outwards of it, above all curves. */
function SpeedsAt({ curve, points }: { curve: PolarCurve; points: Point[] }) {
  return (
    <g class={`curve s${curve.style % COLOURS}`}>
      {points.map((one) => {
        const out = 1 + SPEED_APART / Math.hypot(one.x, one.y);
        const isAtEdge = Math.abs(one.x) * out > SIZE / 2 - SPEED_WIDTH;
        return (
          <text class="speed" x={one.x * out} y={one.y * out + 4} text-anchor={one.x < 0 === isAtEdge ? "start" : "end"}>
            {number(curve.rpm[one.index]!, 4)}
          </text>
        );
      })}
    </g>
  );
}

function regionReach({ region }: PolarCurve): number {
  return region ? Math.hypot(region.real, region.imaginary) + region.semiMajor : 0;
}

const REGION_STEPS = 60;

/** Upwards is negative on the screen. */
function regionPath({ real, imaginary, semiMajor, semiMinor, inclinationDeg }: NonNullable<PolarCurve["region"]>, scale: number): string {
  const turn = (inclinationDeg * Math.PI) / 180;
  const points = Array.from({ length: REGION_STEPS }, (_, step) => {
    const [along, across] = [semiMajor * Math.cos((2 * Math.PI * step) / REGION_STEPS), semiMinor * Math.sin((2 * Math.PI * step) / REGION_STEPS)];
    const [x, y] = [real + along * Math.cos(turn) - across * Math.sin(turn), imaginary + along * Math.sin(turn) + across * Math.cos(turn)];
    return `${(x * scale).toFixed(1)} ${(-y * scale).toFixed(1)}`;
  });
  return `M${points.join("L")}Z`;
}

function columnsOf(curves: PolarCurve[], unit: string): DataColumn[] {
  const rows = curves.flatMap((curve) => curve.rpm.map((speed, at) => [curve.name, speed, curve.amplitude[at] ?? null, curve.lag[at] ?? null]));
  return [t("csvCurve"), t("csvSpeed"), t("amplitude", { unit }), t("lag")].map((name, at) => ({ name, values: rows.map((row) => row[at]!) }));
}

function linePath(points: Point[]): string {
  return points.map((one, index) => `${index ? "L" : "M"}${one.x.toFixed(1)} ${one.y.toFixed(1)}`).join("");
}

function circlePath({ x, y }: Point, radius: number): string {
  const half = (to: number) => `A${radius.toFixed(1)} ${radius.toFixed(1)} 0 1 1 ${(x + to * radius).toFixed(1)} ${y.toFixed(1)}`;
  return `M${(x - radius).toFixed(1)} ${y.toFixed(1)}${half(1)}${half(-1)}`;
}

function pointText(curve: PolarCurve, { index }: Point, unit: string, speedUnit: string): string {
  const speed = curve.vector ? "" : speedUnit === t("rpm") ? `${rpm(curve.rpm[index])}, ` : `${number(curve.rpm[index], 4)} ${speedUnit}, `;
  return t("polarPoint", { name: curve.name, speed, amplitude: number(curve.amplitude[index]), unit, lag: Math.round(withinTurn(curve.lag[index]!, 360)) % 360 });
}
