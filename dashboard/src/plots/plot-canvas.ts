// What is drawn on a plot's canvas besides its curves: baseline bands and markers.
import type uPlot from "uplot";
import { cssColour } from "../browser/theme";
import { MARKER_SIGNS } from "./curve-style";
import type { PlotProps } from "./plot-props";

export function drawBands(plot: uPlot, { bands }: PlotProps): void {
  const { ctx, bbox } = plot;
  const inside = (x: number) => Math.min(bbox.left + bbox.width, Math.max(bbox.left, x));
  ctx.save();
  ctx.fillStyle = cssColour("baseline");
  for (const one of bands ?? []) {
    const left = inside(plot.valToPos(one.from, "x", true));
    const right = one.to === null ? bbox.left + bbox.width : inside(plot.valToPos(one.to, "x", true));
    const top = Math.max(bbox.top, plot.valToPos(one.high, "y", true));
    const bottom = Math.min(bbox.top + bbox.height, plot.valToPos(one.low, "y", true));
    ctx.fillRect(left, top, right - left, bottom - top);
  }
  ctx.restore();
}

/** Height of a limit's name [px]. */
const LABEL = 11;

export function drawLimits(plot: uPlot, { limits }: PlotProps): void {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "alphabetic"; // axes leave another one
  const written: [right: number, y: number][] = [];
  for (const one of limits ?? []) {
    const y = plot.valToPos(one.y, "y", true);
    if (y < bbox.top || y > bbox.top + bbox.height) continue;
    ctx.strokeStyle = ctx.fillStyle = cssColour(one.kind === "note" ? "muted" : one.kind);
    ctx.setLineDash(one.kind === "danger" ? [] : [6 * devicePixelRatio, 4 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
    const gap = 4 * devicePixelRatio;
    // Beside one that is as high: lines that lie close together are named one after another.
    const beside = written.filter(([, other]) => Math.abs(other - y) < LABEL * devicePixelRatio).map(([right]) => right);
    const left = Math.max(bbox.left + gap, ...beside);
    const baseline = y - gap < bbox.top + LABEL * devicePixelRatio ? y + LABEL * devicePixelRatio : y - gap;
    ctx.fillText(one.words, left, baseline);
    written.push([left + ctx.measureText(one.words).width + 2 * gap, y]);
  }
  ctx.restore();
}

export function drawMarkers(plot: uPlot, { markers }: PlotProps): void {
  const { ctx, bbox } = plot;
  ctx.save();
  ctx.font = `${11 * devicePixelRatio}px system-ui, sans-serif`;
  ctx.textAlign = "center";
  for (const one of markers ?? []) {
    const x = plot.valToPos(one.x, "x", true);
    if (x < bbox.left || x > bbox.left + bbox.width) continue;
    ctx.strokeStyle = ctx.fillStyle = cssColour(one.kind === "alert" || one.kind === "danger" ? one.kind : "muted");
    ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    ctx.fillText(MARKER_SIGNS[one.kind], x, bbox.top + 10 * devicePixelRatio);
  }
  ctx.restore();
}
