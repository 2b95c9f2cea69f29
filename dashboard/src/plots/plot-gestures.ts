// Mouse, wheel and fingers on a plot: they zoom, read out and pick points.
import type uPlot from "uplot";
import type { PlotProps } from "./plot-props";
import { syncedPlots, zoom } from "./plot-zoom";

/** A click this near to a point picks it [px]; a finger hides what it points at. */
const NEAR = 20;
const NEAR_FINGER = 32;

/** The wheel zooms with Ctrl only, two fingers zoom and one scrolls, so that the page can be scrolled over a plot. */
export function addGestures(plot: uPlot, latest: { current: PlotProps }): void {
  const { over } = plot;
  over.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    zoom(plot, event.deltaY < 0 ? 0.8 : 1.25);
  }, { passive: false });
  over.addEventListener("dblclick", () => syncedPlots(plot).forEach((one) => (one.root.dataset.zoomed = "0")));
  for (const kind of ["pointerenter", "pointerdown"] as const) {
    over.addEventListener(kind, (event) => (plot.root.dataset.pointer = event.pointerType));
  }
  addPinch(plot);
  addPick(plot, latest);
}

export function isTouched(plot: uPlot): boolean {
  return plot.root.dataset.pointer === "touch";
}

/** A click on a point picks it. A first tap only reads it out, since a finger cannot hover. */
function addPick(plot: uPlot, latest: { current: PlotProps }): void {
  let tapped: number | null = null;
  plot.over.addEventListener("click", (event) => {
    const { onPick } = latest.current;
    if (!onPick || plot.select.width > 0) return;
    const box = plot.over.getBoundingClientRect();
    const finger = isTouched(plot);
    const index = nearestPoint(plot, latest.current, event.clientX - box.left, event.clientY - box.top, finger ? NEAR_FINGER : NEAR);
    const x = index === null ? null : plot.data[0][index]!;
    if (index !== null && (!finger || x === tapped)) onPick(index);
    else if (x !== null) plot.setCursor({ left: plot.valToPos(x, "x"), top: event.clientY - box.top });
    tapped = x;
  });
}

/** The point nearest to a position, if it is near [px]. */
function nearestPoint(plot: uPlot, { x, curves }: PlotProps, left: number, top: number, near: number): number | null {
  let found: number | null = null;
  let least = near;
  for (const { y } of curves) {
    y.forEach((value, index) => {
      if (value === null) return;
      const distance = Math.hypot(plot.valToPos(x[index]!, "x") - left, plot.valToPos(value, "y") - top);
      if (distance <= least) [least, found] = [distance, index];
    });
  }
  return found;
}

function addPinch(plot: uPlot): void {
  let before = 0;
  plot.over.addEventListener("touchstart", ({ touches }) => (before = fingerDistance(touches)));
  plot.over.addEventListener("touchmove", (event) => {
    const [one, other] = event.touches;
    if (!one || !other) return;
    event.preventDefault();
    const now = fingerDistance(event.touches);
    if (before > 0 && now > 0) zoom(plot, before / now, (one.clientX + other.clientX) / 2 - plot.over.getBoundingClientRect().left);
    before = now;
  }, { passive: false });
}

/** Distance of two fingers [px]; 0 unless there are two. */
function fingerDistance({ 0: one, 1: other }: TouchList): number {
  return one && other ? Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY) : 0;
}
