// Zoom and read-out of a plot, together with the plots of its group.
import uPlot from "uplot";
import type { PlotProps } from "./plot-props";
import { nearestRow, readableRows } from "./read-out";

/** One step of keys and buttons. */
export const ZOOM_STEP = 0.6;
/** Above a plot's upper edge, but not outside of it [px]. */
const ABOVE = 0;

/** The plots that share cursor and zoom with a plot, itself included. */
export function syncedPlots(plot: uPlot): uPlot[] {
  const key = plot.cursor.sync?.key;
  return key ? uPlot.sync(key).plots : [plot];
}

export function isZoomed(plot: uPlot): boolean {
  const { min, max } = plot.scales.x!;
  const x = plot.data[0];
  return min !== undefined && max !== undefined && min !== null && max !== null && x.length > 1 && plot.root.dataset.zoomed === "1";
}

export function rangeOf(plot: uPlot): [number, number] {
  return [plot.scales.x!.min!, plot.scales.x!.max!];
}

export function zoomTo(plot: uPlot, min: number, max: number): void {
  plot.root.dataset.zoomed = "1";
  plot.setScale("x", { min, max });
}

/** Zoom a plot that is created later than the others of its group to where they are zoomed. */
export function zoomLikeGroup(plot: uPlot): void {
  const other = syncedPlots(plot).find((one) => one !== plot && isZoomed(one));
  if (other) zoomTo(plot, ...rangeOf(other));
}

export function showAll(plot: uPlot): void {
  for (const one of syncedPlots(plot)) {
    one.root.dataset.zoomed = "0";
    one.setData(one.data, true);
  }
}

/** left: where the plot stays in place [px]; negative: its middle. */
export function zoom(plot: uPlot, factor: number, left = plot.cursor.left ?? -1): void {
  const { min, max } = plot.scales.x!;
  if (min === undefined || max === undefined || min === null || max === null) return;
  const fixed = left >= 0 ? plot.posToVal(left, "x") : (min + max) / 2;
  for (const one of syncedPlots(plot)) {
    zoomTo(one, fixed - (fixed - min) * factor, fixed + (max - fixed) * factor);
  }
}

/** Move the read-out by so many of the points in sight. */
export function moveReadOut(plot: uPlot, props: PlotProps, by: number): void {
  const { min = -Infinity, max = Infinity } = plot.scales.x! as { min?: number; max?: number };
  const rows = readableRows(props).filter((row) => props.x[row]! >= min && props.x[row]! <= max);
  if (rows.length === 0) return;
  const current = plot.cursor.idx ?? null;
  const place = current === null ? rows.length - 1 : rows.indexOf(nearestRow(props.x, rows, current)!);
  const row = rows[Math.min(rows.length - 1, Math.max(0, place + by))]!;
  readOutAt(plot, props.x[row]!);
}

/** Read out an x in the whole group; the horizontal cursor line would lie on no value, so it is moved out of sight. */
function readOutAt(plot: uPlot, x: number): void {
  for (const one of syncedPlots(plot)) one.setCursor({ left: one.valToPos(x, "x"), top: ABOVE });
}
