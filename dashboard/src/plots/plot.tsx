// A plot over time or speed: uPlot with bands, markers, zoom, and a read-out at the cursor, also by keys and fingers.
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { number } from "../words/format";
import { named, nearestOf, stops, values } from "./read-out";
import { useStore } from "../browser/store";
import { colour, shown } from "../browser/theme";

export interface Curve {
  name: string;
  y: (number | null)[];
  /** Number of its colour and dash; by default its place. */
  style?: number;
  points?: boolean;
  line?: boolean;
  /** Bounds around it, drawn as a band. */
  lower?: (number | null)[];
  upper?: (number | null)[];
  /** Beside the others for comparison: paler. */
  faint?: boolean;
  /** Joined over points that other curves have and it has not. */
  spans?: boolean;
  /** Not named above the plot nor read out: it goes with another. */
  aside?: boolean;
}

export interface Marker {
  x: number;
  kind: "alert" | "danger" | "maintenance" | "note" | "speed";
  words: string;
}

export interface Band {
  low: number;
  high: number;
  from: number;
  /** Null: to the right edge. */
  to: number | null;
}

export interface PlotProps {
  label: string;
  x: number[];
  curves: Curve[];
  /** Seconds since 1970 along x, shown as local time. */
  time?: boolean;
  xUnit?: string;
  yUnit: string;
  xRange?: [number, number];
  yRange?: [number, number];
  /** Ranges that y should lie in, each over a stretch of x. */
  bands?: Band[];
  markers?: Marker[];
  height?: number;
  /** Plots of the same name move their cursors and zoom together. */
  together?: string;
  /** What is said of the point at the cursor; by default every curve's value. */
  readOut?: (index: number) => string;
  onPick?: (index: number) => void;
}

const DASHES: number[][] = [[], [7, 3], [2, 3], [9, 3, 2, 3], [12, 4], [4, 2]];
/** Colours and dashes of curves; beyond them they begin again. */
export const STYLES = 6;
/** Signs of the markers. */
export const MARKS: Record<Marker["kind"], string> = { alert: "▲", danger: "◆", maintenance: "✚", note: "●", speed: "" };
/** Of a curve, by its style: beyond the last colour the dashes move on by one, so that no two curves look alike. */
function dash(style: number): number[] {
  return DASHES[(style + Math.floor(style / STYLES)) % DASHES.length]!;
}

const ALPHA = 0.2;
/** Characters of a value that is read out, with what stands around it; and of a line of a phone. */
const VALUE = 9;
const LINE = 48;
/** As one step of keys and buttons does. */
const ZOOM = 0.6;
/** A click so near to a point picks it [px]; a finger hides what it points at. */
const NEAR = 20;
const NEAR_FINGER = 32;
/** Above a plot's upper edge, but not away from it [px]. */
const BESIDE = 0;
const DAY_S = 86_400;
/** Labels of a time axis by the distance of its marks: what every mark says, and what is added where year or day changes. */
const DATES: uPlot.Axis.Values = [
  [365 * DAY_S, "{YYYY}", null, null, null, null, null, null, 1],
  [28 * DAY_S, "{MMM}", "\n{YYYY}", null, null, null, null, null, 1],
  [DAY_S, "{D} {MMM}", "\n{YYYY}", null, null, null, null, null, 1],
  [3600, "{HH}:{mm}", "\n{D} {MMM} {YYYY}", null, "\n{D} {MMM}", null, null, null, 1],
  [60, "{HH}:{mm}", "\n{D} {MMM} {YYYY}", null, "\n{D} {MMM}", null, null, null, 1],
  [1, "{HH}:{mm}:{ss}", "\n{D} {MMM} {YYYY}", null, "\n{D} {MMM}", null, null, null, 1],
];

export function Plot(props: PlotProps) {
  const place = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  /** Where the one before was zoomed to. */
  const before = useRef<[number, number] | null>(null);
  const madeOf = useRef<PlotProps | null>(null);
  const [at, setAt] = useState<number | null>(null);
  const theme = useStore(shown);
  const latest = useRef(props);
  latest.current = props;
  const height = props.height ?? 200;
  const shape = JSON.stringify([props.curves.map((one) => [one.name, one.style, one.points, one.line, one.faint, !!one.lower]), theme, height, props.yUnit]);

  useEffect(() => {
    const node = place.current!;
    const made = new uPlot(options(latest, height, node.clientWidth, setAt), data(latest.current), node);
    plot.current = made;
    madeOf.current = latest.current;
    if (before.current) zoomTo(made, ...before.current);
    else queueMicrotask(() => plot.current === made && zoomAsBeside(made)); // those beside it have their scales by then
    // Made anew as wide as its place: a phone is turned, a window is dragged.
    const sizes = new ResizeObserver(() => {
      if (node.clientWidth > 0 && node.clientWidth !== made.width) made.setSize({ width: node.clientWidth, height });
    });
    sizes.observe(node);
    return () => {
      sizes.disconnect();
      before.current = zoomed(made) ? rangeOf(made) : null;
      made.destroy();
      plot.current = null;
    };
  }, [shape]);

  useEffect(() => {
    const made = plot.current;
    if (!made || madeOf.current === props) return;
    const kept = zoomed(made);
    made.setData(data(props), !kept);
    if (kept) made.redraw();
  }, [props.x, props.curves, props.bands, props.markers, props.xRange?.[0], props.xRange?.[1]]);

  const last = props.x.length - 1;
  const index = at !== null && at <= last ? at : null;
  return (
    <div class="plot" role="group" tabIndex={0} aria-label={`${props.label}. Arrow keys move the read-out${props.onPick ? ", Enter picks its point" : ""}.`} onKeyDown={(event) => keyed(event, plot.current, props)}>
      <div class="above">
        <div class="readout" aria-live="off" style={{ "--lines": lines(props) }}>
          {last < 0 ? "no values" : index === null ? (props.readOut && props.time ? `newest: ${props.readOut(last)}` : "") : props.readOut ? props.readOut(index) : values(props, index)}
          {index === null && !props.readOut && <Names curves={props.curves} />}
        </div>
        <Zooms plot={plot} />
      </div>
      <div ref={place} class="canvas" style={{ height: `${height}px` }} />
    </div>
  );
}

function Zooms({ plot }: { plot: { current: uPlot | null } }) {
  const button = (sign: string, label: string, act: (made: uPlot) => void) => (
    <button type="button" aria-label={label} title={label} onClick={() => plot.current && act(plot.current)}>
      {sign}
    </button>
  );
  return (
    <span class="zooms screen">
      {button("+", "Zoom in", (made) => zoom(made, ZOOM))}
      {button("−", "Zoom out", (made) => zoom(made, 1 / ZOOM))}
      {button("all", "Show all", showAll)}
    </span>
  );
}

export function Names({ curves }: { curves: Pick<Curve, "name" | "style" | "faint" | "aside">[] }) {
  return (
    <span class="names">
      {named(curves).map((one, index) => (
        <span key={one.name}>
          <svg class={`curve s${(one.style ?? index) % STYLES}`} width={24} height={8} aria-hidden="true">
            <path d="M0 4h24" stroke-dasharray={dash(one.style ?? index).join(" ")} />
          </svg>{" "}
          {one.name}
        </span>
      ))}
    </span>
  );
}

/** What a read-out may take on a phone: its place is kept, so that plots below it stay where they are. */
function lines({ readOut, curves, yUnit }: PlotProps): number {
  if (readOut) return 2;
  const said = named(curves).map((one) => one.name.length + VALUE);
  return Math.max(2, Math.ceil((VALUE + yUnit.length + said.reduce((sum, one) => sum + one, 0)) / LINE));
}

function data(props: PlotProps): uPlot.AlignedData {
  const columns: (number | null)[][] = [];
  for (const one of props.curves) {
    columns.push(one.y);
    if (one.lower && one.upper) columns.push(one.lower, one.upper);
  }
  return [props.x, ...columns] as uPlot.AlignedData;
}

function zoomed(made: uPlot): boolean {
  const { min, max } = made.scales.x!;
  const x = made.data[0];
  return min !== undefined && max !== undefined && min !== null && max !== null && x.length > 1 && made.root.dataset.zoomed === "1";
}

function rangeOf(made: uPlot): [number, number] {
  return [made.scales.x!.min!, made.scales.x!.max!];
}

/** To what plots beside it are zoomed to already: it may come later than they. */
function zoomAsBeside(made: uPlot): void {
  const other = together(made).find((one) => one !== made && zoomed(one));
  if (other) zoomTo(made, ...rangeOf(other));
}

function keyed(event: KeyboardEvent, made: uPlot | null, props: PlotProps): void {
  const { x, onPick } = props;
  const last = x.length - 1;
  if (!made || last < 0) return;
  if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
    step(made, props, (event.key === "ArrowLeft" ? -1 : 1) * (event.shiftKey ? 10 : 1));
  } else if (event.key === "+" || event.key === "-") {
    zoom(made, event.key === "+" ? ZOOM : 1 / ZOOM);
  } else if (event.key === "0" || event.key === "Escape") showAll(made);
  // On one of its buttons Enter presses that.
  else if (event.key === "Enter" && onPick && event.target === event.currentTarget) onPick(Math.min(last, made.cursor.idx ?? last));
  else return;
  event.preventDefault();
}

/** Move the read-out by so many of the points in sight. */
function step(made: uPlot, props: PlotProps, by: number): void {
  const { min = -Infinity, max = Infinity } = made.scales.x! as { min?: number; max?: number };
  const rows = stops(props).filter((row) => props.x[row]! >= min && props.x[row]! <= max);
  if (rows.length === 0) return;
  const here = made.cursor.idx ?? null;
  const place = here === null ? rows.length - 1 : rows.indexOf(nearestOf(props.x, rows, here)!);
  const to = rows[Math.min(rows.length - 1, Math.max(0, place + by))]!;
  readOut(made, props.x[to]!);
}

/** Read out a place of the x axis, here and in the plots beside it; the line across lies on no value, so it is out of sight. */
function readOut(made: uPlot, x: number): void {
  for (const one of together(made)) one.setCursor({ left: one.valToPos(x, "x"), top: BESIDE });
}

/** A plot and those that it zooms together with. */
function together(made: uPlot): uPlot[] {
  const key = made.cursor.sync?.key;
  return key ? uPlot.sync(key).plots : [made];
}

function showAll(made: uPlot): void {
  for (const one of together(made)) {
    one.root.dataset.zoomed = "0";
    one.setData(one.data, true);
  }
}

/** left: of what stays in its place [px]; negative: the middle. */
function zoom(made: uPlot, factor: number, left = made.cursor.left ?? -1): void {
  const { min, max } = made.scales.x!;
  if (min === undefined || max === undefined || min === null || max === null) return;
  const middle = left >= 0 ? made.posToVal(left, "x") : (min + max) / 2;
  for (const one of together(made)) {
    zoomTo(one, middle - (middle - min) * factor, middle + (max - middle) * factor);
  }
}

function zoomTo(made: uPlot, min: number, max: number): void {
  made.root.dataset.zoomed = "1";
  made.setScale("x", { min, max });
}

/** An axis that says its unit [px]. */
function titled(label: string, size: number, labelSize: number): uPlot.Axis {
  return { label, size, labelSize, labelFont: "11px system-ui, sans-serif", labelGap: 0 };
}

function options(
  latest: { current: PlotProps },
  height: number,
  width: number,
  onCursor: (index: number | null) => void,
): uPlot.Options {
  const props = latest.current;
  const axis: uPlot.Axis = { stroke: colour("muted"), grid: { stroke: colour("grid"), width: 1 }, ticks: { stroke: colour("grid"), size: 4 }, font: "11px system-ui, sans-serif" };
  const series: uPlot.Series[] = [{}];
  const bands: uPlot.Band[] = [];
  props.curves.forEach((one, index) => {
    const style = one.style ?? index;
    const stroke = one.faint ? colour("faint") : colour(`s${style % STYLES}`);
    series.push({
      label: one.name,
      stroke,
      width: one.line === false ? 0 : one.faint ? 1 : 1.6,
      dash: dash(style),
      points: { show: one.points ?? false, size: one.faint ? 4 : 5, width: 1, stroke, fill: one.faint ? "transparent" : stroke },
      spanGaps: one.spans ?? false,
    });
    if (one.lower && one.upper) {
      const main = series.length - 1;
      const bound: uPlot.Series = { stroke: "transparent", points: { show: false }, width: 0, spanGaps: one.spans ?? false };
      series.push(bound, { ...bound });
      bands.push({ series: [main + 2, main + 1], fill: faded(stroke) });
    }
  });
  return {
    width: Math.max(width, 50),
    height,
    series,
    bands,
    legend: { show: false },
    scales: {
      x: { time: props.time ?? false, range: (_, min, max) => xRange(latest.current, min, max) },
      y: { range: (_, min, max) => yRange(latest.current, min, max) },
    },
    axes: [
      { ...axis, ...(props.xUnit ? titled(props.xUnit, 30, 14) : { size: 34 }), values: props.time ? DATES : (_, ticks) => ticks.map((tick) => String(tick)) },
      { ...axis, ...titled(props.yUnit, 54, 16), values: (_, ticks) => ticks.map(short) },
    ],
    cursor: {
      drag: { x: true, y: false, setScale: true },
      points: { size: 7 },
      // Marked is what is read out, not only where all curves have a point.
      ...(props.readOut ? {} : { hover: { skip: [null], prox: Number.MAX_VALUE } }),
      // A finger that is lifted, or taps a button, leaves the read-out where it was.
      bind: { mouseleave: (made, _, leave) => (event) => (byFinger(made) ? null : leave(event)) },
      ...(props.together ? { sync: { key: props.together } } : {}),
    },
    hooks: {
      drawAxes: [(made) => drawBands(made, latest.current)],
      draw: [(made) => markers(made, latest.current)],
      setCursor: [(made) => onCursor(made.cursor.idx ?? null)],
      setSelect: [(made) => made.select.width > 0 && (made.root.dataset.zoomed = "1")],
      ready: [(made) => controls(made, latest)],
    },
  };
}

function xRange(props: PlotProps, min: number | null, max: number | null): [number, number] {
  if (min === null || max === null) return props.xRange ?? [0, 1];
  const x = props.x;
  const all = x.length > 0 && min === x[0] && max === x.at(-1);
  if (all && props.xRange) return props.xRange;
  return min === max ? [min - 1, max + 1] : all ? [min - 0.02 * (max - min), max + 0.02 * (max - min)] : [min, max];
}

function yRange(props: PlotProps, min: number | null, max: number | null): [number, number] {
  if (props.yRange) return props.yRange;
  if (min === null || max === null) return [0, 1];
  const low = Math.min(min, ...(props.bands ?? []).map((one) => one.low));
  const high = Math.max(max, ...(props.bands ?? []).map((one) => one.high));
  const room = 0.06 * (high - low || Math.abs(high) || 1);
  return [low >= 0 && low - room < 0 ? 0 : low - room, high + room];
}

function short(tick: number): string {
  const text = number(tick, 4);
  return text.includes(".") && !text.includes("e") ? text.replace(/\.?0+$/, "") : text;
}

function faded(stroke: string): string {
  return /^#[0-9a-f]{6}$/i.test(stroke) ? `${stroke}${Math.round(255 * ALPHA).toString(16)}` : stroke;
}

function drawBands(made: uPlot, { bands: wanted }: PlotProps): void {
  const { ctx, bbox } = made;
  const inside = (x: number) => Math.min(bbox.left + bbox.width, Math.max(bbox.left, x));
  ctx.save();
  ctx.fillStyle = colour("baseline");
  for (const one of wanted ?? []) {
    const left = inside(made.valToPos(one.from, "x", true));
    const right = one.to === null ? bbox.left + bbox.width : inside(made.valToPos(one.to, "x", true));
    const top = Math.max(bbox.top, made.valToPos(one.high, "y", true));
    const bottom = Math.min(bbox.top + bbox.height, made.valToPos(one.low, "y", true));
    ctx.fillRect(left, top, right - left, bottom - top);
  }
  ctx.restore();
}

function markers(made: uPlot, { markers: wanted }: PlotProps): void {
  const { ctx, bbox } = made;
  ctx.save();
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "center";
  for (const one of wanted ?? []) {
    const x = made.valToPos(one.x, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.strokeStyle = ctx.fillStyle = colour(one.kind === "alert" || one.kind === "danger" ? one.kind : "muted");
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.fillText(MARKS[one.kind], x, bbox.top + 10 * devicePixelRatio);
  }
  ctx.restore();
}

/** The wheel zooms with Ctrl, so that the page still scrolls; two fingers do, and one scrolls. */
function controls(made: uPlot, latest: { current: PlotProps }): void {
  const { over } = made;
  over.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(made, event.deltaY < 0 ? 0.8 : 1.25);
  }, { passive: false });
  over.addEventListener("dblclick", () => together(made).forEach((one) => (one.root.dataset.zoomed = "0")));
  for (const kind of ["pointerenter", "pointerdown"] as const) {
    over.addEventListener(kind, (event) => (made.root.dataset.pointer = event.pointerType));
  }
  pinches(made);
  picks(made, latest);
}

function byFinger(made: uPlot): boolean {
  return made.root.dataset.pointer === "touch";
}

/** A click on a point picks it. A first tap on it only reads it out: there is no hovering with a finger. */
function picks(made: uPlot, latest: { current: PlotProps }): void {
  let tapped: number | null = null;
  made.over.addEventListener("click", (event) => {
    const { onPick } = latest.current;
    if (!onPick || made.select.width > 0) return;
    const box = made.over.getBoundingClientRect();
    const finger = byFinger(made);
    const index = nearest(made, latest.current, event.clientX - box.left, event.clientY - box.top, finger ? NEAR_FINGER : NEAR);
    const x = index === null ? null : made.data[0][index]!;
    if (index !== null && (!finger || x === tapped)) onPick(index);
    else if (x !== null) made.setCursor({ left: made.valToPos(x, "x"), top: event.clientY - box.top });
    tapped = x;
  });
}

/** The point that is nearest to a place, if it is near [px]. */
function nearest(made: uPlot, { x, curves }: PlotProps, left: number, top: number, near: number): number | null {
  let found: number | null = null;
  let least = near;
  for (const { y } of curves) {
    y.forEach((value, index) => {
      if (value === null) return;
      const far = Math.hypot(made.valToPos(x[index]!, "x") - left, made.valToPos(value, "y") - top);
      if (far <= least) [least, found] = [far, index];
    });
  }
  return found;
}

function pinches(made: uPlot): void {
  let before = 0;
  made.over.addEventListener("touchstart", ({ touches }) => (before = apart(touches)));
  made.over.addEventListener("touchmove", (event) => {
    const [one, other] = event.touches;
    if (!one || !other) return;
    event.preventDefault();
    const now = apart(event.touches);
    if (before > 0 && now > 0) zoom(made, before / now, (one.clientX + other.clientX) / 2 - made.over.getBoundingClientRect().left);
    before = now;
  }, { passive: false });
}

/** How far two fingers are from each other [px]; 0: there are not two. */
function apart({ 0: one, 1: other }: TouchList): number {
  return one && other ? Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) : 0;
}
