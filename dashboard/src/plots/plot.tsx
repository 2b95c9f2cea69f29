// A plot over time or speed: uPlot with bands, markers, zoom, and a read-out at the cursor, also by keys and fingers.
import { useEffect, useRef, useState } from "preact/hooks";
import uPlot from "uplot";
import { useStore } from "../browser/store";
import { activeTheme } from "../browser/theme";
import { t } from "../messages/messages";
import { CurveLegend } from "./curve-legend";
import { plotData, plotOptions } from "./plot-options";
import type { PlotProps } from "./plot-props";
import { isZoomed, moveReadOut, rangeOf, showAll, zoom, ZOOM_STEP, zoomLikeGroup, zoomTo } from "./plot-zoom";
import { dataColumns, readOutLines, valuesText } from "./read-out";
import { SaveButtons } from "./save-buttons";

const DEFAULT_HEIGHT = 200;

export function Plot(props: PlotProps) {
  const container = useRef<HTMLDivElement>(null);
  const [at, setAt] = useState<number | null>(null);
  const plot = useUPlot(container, props, setAt);
  const last = props.x.length - 1;
  const index = at !== null && at <= last ? at : null;
  return (
    <div class="plot" role="group" tabIndex={0} aria-label={t("plotKeys", { label: props.label, pick: props.onPick ? t("enterPicksItsPoint") : "" })} onKeyDown={(event) => onKey(event, plot.current, props)}>
      <div class="above">
        <div class="readout" aria-live="off" style={{ "--lines": readOutLines(props) }}>
          {last < 0 ? t("noValues") : index === null ? (props.readOut && props.time ? t("newestValues", { values: props.readOut(last) }) : "") : props.readOut ? props.readOut(index) : valuesText(props, index)}
          {index === null && !props.readOut && <CurveLegend curves={props.curves} />}
        </div>
        <span class="zooms screen">
          <ZoomButtons plot={plot} />
          <SaveButtons label={props.label} columns={() => dataColumns(props)} canvas={() => plot.current?.ctx.canvas} />
        </span>
      </div>
      <div ref={container} class="canvas" style={{ height: `${props.height ?? DEFAULT_HEIGHT}px` }} />
    </div>
  );
}

/** Keep a plot in a container up to date with its properties; it is created anew when its curves or the theme change. */
function useUPlot(container: { current: HTMLDivElement | null }, props: PlotProps, onCursor: (index: number | null) => void): { current: uPlot | null } {
  const plot = useRef<uPlot | null>(null);
  const zoomBefore = useRef<[number, number] | null>(null);
  const createdWith = useRef<PlotProps | null>(null);
  const theme = useStore(activeTheme);
  const latest = useRef(props);
  latest.current = props;
  const height = props.height ?? DEFAULT_HEIGHT;
  const shape = JSON.stringify([props.curves.map((one) => [one.name, one.style, one.points, one.line, one.faint, !!one.lower]), theme, height, props.yUnit]);

  useEffect(() => {
    const node = container.current!;
    const created = new uPlot(plotOptions(latest, height, node.clientWidth, onCursor), plotData(latest.current), node);
    plot.current = created;
    createdWith.current = latest.current;
    if (zoomBefore.current) zoomTo(created, ...zoomBefore.current);
    else queueMicrotask(() => plot.current === created && zoomLikeGroup(created)); // the others have their scales by then
    const observer = followWidth(created, node, height);
    return () => {
      observer.disconnect();
      zoomBefore.current = isZoomed(created) ? rangeOf(created) : null;
      created.destroy();
      plot.current = null;
    };
  }, [shape]);

  useEffect(() => {
    const current = plot.current;
    if (!current || createdWith.current === props) return;
    const keepZoom = isZoomed(current);
    current.setData(plotData(props), !keepZoom);
    if (keepZoom) current.redraw();
  }, [props.x, props.curves, props.bands, props.markers, props.xRange?.[0], props.xRange?.[1]]);
  return plot;
}

/** Keep a plot as wide as its container: a phone is turned, a window is resized. */
function followWidth(plot: uPlot, container: HTMLElement, height: number): ResizeObserver {
  const observer = new ResizeObserver(() => {
    if (container.clientWidth > 0 && container.clientWidth !== plot.width) plot.setSize({ width: container.clientWidth, height });
  });
  observer.observe(container);
  return observer;
}

function ZoomButtons({ plot }: { plot: { current: uPlot | null } }) {
  const button = (sign: string, label: string, act: (plot: uPlot) => void) => (
    <button type="button" aria-label={label} title={label} onClick={() => plot.current && act(plot.current)}>
      {sign}
    </button>
  );
  return (
    <>
      {button("+", t("zoomIn"), (one) => zoom(one, ZOOM_STEP))}
      {button("−", t("zoomOut"), (one) => zoom(one, 1 / ZOOM_STEP))}
      {button(t("allPoints"), t("showAll"), showAll)}
    </>
  );
}

function onKey(event: KeyboardEvent, plot: uPlot | null, props: PlotProps): void {
  const { x, onPick } = props;
  const last = x.length - 1;
  if (!plot || last < 0) return;
  if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
    moveReadOut(plot, props, (event.key === "ArrowLeft" ? -1 : 1) * (event.shiftKey ? 10 : 1));
  } else if (event.key === "+" || event.key === "-") {
    zoom(plot, event.key === "+" ? ZOOM_STEP : 1 / ZOOM_STEP);
  } else if (event.key === "0" || event.key === "Escape") showAll(plot);
  // On one of the buttons, Enter presses that.
  else if (event.key === "Enter" && onPick && event.target === event.currentTarget) onPick(Math.min(last, plot.cursor.idx ?? last));
  else return;
  event.preventDefault();
}
