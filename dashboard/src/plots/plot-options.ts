// A plot's properties as options of uPlot: series, bands, scales, axes, cursor.
import type uPlot from "uplot";
import { cssColour } from "../browser/theme";
import { decimal, number } from "../format/numbers";
import { COLOURS, dash, transparent } from "./curve-style";
import { drawBands, drawLimits, drawMarkers } from "./plot-canvas";
import { addGestures, isTouched } from "./plot-gestures";
import type { Curve, PlotProps } from "./plot-props";
import { withinTurn } from "./read-out";

const DAY_S = 86_400;
/** Round steps of an axis of angles [°]. */
const TURN_STEPS = [15, 30, 45, 90, 180, 360, 720];
/** So near ticks of such an axis may be [px]: from turn to turn they would all read 0. */
const TURN_SPACE = 16;
const FONT = "11px system-ui, sans-serif";
/** Labels of a time axis by the distance of its ticks: of every tick, and what is added where the year or day changes. */
const DATES: uPlot.Axis.Values = [
  [365 * DAY_S, "{YYYY}", null, null, null, null, null, null, 1],
  [28 * DAY_S, "{YYYY}-{MM}", null, null, null, null, null, null, 1],
  [DAY_S, "{MM}-{DD}", "\n{YYYY}", null, null, null, null, null, 1],
  [3600, "{HH}:{mm}", "\n{YYYY}-{MM}-{DD}", null, "\n{MM}-{DD}", null, null, null, 1],
  [60, "{HH}:{mm}", "\n{YYYY}-{MM}-{DD}", null, "\n{MM}-{DD}", null, null, null, 1],
  [1, "{HH}:{mm}:{ss}", "\n{YYYY}-{MM}-{DD}", null, "\n{MM}-{DD}", null, null, null, 1],
];

/** A plot's columns: x, and of each curve its values and bounds. */
export function plotData(props: PlotProps): uPlot.AlignedData {
  const columns: (number | null)[][] = [];
  for (const one of props.curves) {
    columns.push(one.y);
    if (one.lower && one.upper) columns.push(one.lower, one.upper);
  }
  return [props.x, ...columns] as uPlot.AlignedData;
}

/** latest: the properties that the plot has by the time something is drawn. */
export function plotOptions(latest: { current: PlotProps }, height: number, width: number, onCursor: (index: number | null) => void): uPlot.Options {
  const props = latest.current;
  return {
    width: Math.max(width, 50),
    height,
    ...seriesAndBands(props.curves),
    legend: { show: false },
    scales: {
      x: { time: props.time ?? false, range: (_, min, max) => xRange(latest.current, min, max) },
      y: { range: (_, min, max) => yRange(latest.current, min, max) },
    },
    axes: axes(props),
    cursor: cursor(props),
    hooks: {
      drawAxes: [(plot) => drawBands(plot, latest.current), (plot) => drawLimits(plot, latest.current)],
      draw: [(plot) => drawMarkers(plot, latest.current)],
      setCursor: [(plot) => onCursor(plot.cursor.idx ?? null)],
      setSelect: [(plot) => plot.select.width > 0 && (plot.root.dataset.zoomed = "1")],
      ready: [(plot) => addGestures(plot, latest)],
    },
  };
}

function seriesAndBands(curves: Curve[]): { series: uPlot.Series[]; bands: uPlot.Band[] } {
  const series: uPlot.Series[] = [{}];
  const bands: uPlot.Band[] = [];
  curves.forEach((one, index) => {
    const style = one.style ?? index;
    const stroke = one.faint ? cssColour("faint") : cssColour(`s${style % COLOURS}`);
    series.push({
      label: one.name,
      stroke,
      width: one.line === false ? 0 : one.faint ? 1 : 1.6,
      dash: dash(style),
      points: { show: one.points ?? false, size: one.faint ? 4 : 5, width: 1, stroke, fill: one.faint ? "transparent" : stroke },
      spanGaps: one.spanGaps ?? false,
    });
    if (one.lower && one.upper) {
      const main = series.length - 1;
      const bound: uPlot.Series = { stroke: "transparent", points: { show: false }, width: 0, spanGaps: one.spanGaps ?? false };
      series.push(bound, { ...bound });
      bands.push({ series: [main + 2, main + 1], fill: transparent(stroke) });
    }
  });
  return { series, bands };
}

function axes(props: PlotProps): uPlot.Axis[] {
  const axis: uPlot.Axis = { stroke: cssColour("muted"), grid: { stroke: cssColour("grid"), width: 1 }, ticks: { stroke: cssColour("grid"), size: 4 }, font: FONT };
  const x = props.xUnit ? titled(props.xUnit, 30, 14) : { size: 34 };
  return [
    { ...axis, ...x, values: props.time ? DATES : (_, ticks) => ticks.map((tick) => decimal(String(tick))) },
    { ...axis, ...titled(props.yUnit, 54, 16), ...(props.turn ? { incrs: TURN_STEPS, space: TURN_SPACE } : {}), values: (_, ticks) => tickLabels(props.turn ? ticks.map((tick) => withinTurn(tick, props.turn!)) : ticks) },
  ];
}

/** An axis titled with its unit [px]. */
function titled(label: string, size: number, labelSize: number): uPlot.Axis {
  return { label, size, labelSize, labelFont: FONT, labelGap: 0 };
}

/** Relative difference below which values are the same for the eye [-]. */
const FLAT = 1e-6;
const MOST_DIGITS = 9;

/** Labels with as many digits as distinguish neighbours. */
function tickLabels(ticks: number[]): string[] {
  for (let digits = 4; digits < MOST_DIGITS; digits += 1) {
    const labels = ticks.map((tick) => tickLabel(tick, digits));
    if (ticks.every((tick, at) => at === 0 || tick === ticks[at - 1] || labels[at] !== labels[at - 1])) return labels;
  }
  return ticks.map((tick) => tickLabel(tick, MOST_DIGITS));
}

function tickLabel(tick: number, digits: number): string {
  const text = number(tick, digits);
  return /[.,]/.test(text) && !text.includes("e") ? text.replace(/[.,]?0+$/, "") : text;
}

function cursor(props: PlotProps): uPlot.Cursor {
  return {
    drag: { x: true, y: false, setScale: true },
    points: { size: 7 },
    // The points that are read out are marked, not only those where all curves have one.
    ...(props.readOut ? {} : { hover: { skip: [null], prox: Number.MAX_VALUE } }),
    // A finger that is lifted, or taps a button, leaves the read-out where it was.
    bind: { mouseleave: (plot, _, leave) => (event) => (isTouched(plot) ? null : leave(event)) },
    ...(props.syncGroup ? { sync: { key: props.syncGroup } } : {}),
  };
}

function xRange(props: PlotProps, min: number | null, max: number | null): [number, number] {
  if (min === null || max === null) return props.xRange ?? [0, 1];
  const x = props.x;
  const isAll = x.length > 0 && min === x[0] && max === x.at(-1);
  if (isAll && props.xRange) return props.xRange;
  return min === max ? [min - 1, max + 1] : isAll ? [min - 0.02 * (max - min), max + 0.02 * (max - min)] : [min, max];
}

function yRange(props: PlotProps, min: number | null, max: number | null): [number, number] {
  if (props.yRange) return props.yRange;
  if (min === null || max === null) return [0, 1];
  const low = Math.min(min, ...(props.bands ?? []).map((one) => one.low), ...(props.limits ?? []).map((one) => one.y));
  const high = Math.max(max, ...(props.bands ?? []).map((one) => one.high), ...(props.limits ?? []).map((one) => one.y));
  const size = Math.max(Math.abs(low), Math.abs(high));
  // What hardly differs is drawn flat: an axis of the last digits would show nothing but rounding.
  const margin = high - low > FLAT * size ? 0.06 * (high - low) : 0.06 * (size || 1);
  return [low >= 0 && low - margin < 0 ? 0 : low - margin, high + margin];
}
