// The history of one parameter: its estimates with intervals, the baseline's band, and the results of its trend tests.
import { navigate } from "../browser/router";
import { useUnits } from "../browser/units";
import { angleText } from "../format/angles";
import { isCrossCoupled } from "../format/names";
import { number, percent, scaled, scaleOf, type Scale } from "../format/numbers";
import { t, term } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { Band, Curve, Marker } from "../plots/plot-props";
import type { BaselineBand, Series, TrendTest } from "../schemas/trends";
import { trendTestTexts } from "../words/trend-tests";
import { AngleHistoryPlot } from "./angle-history-plot";
import { atOnce, curveName, historyPoints, overAll, pointHead, seconds, type HistoryPoint, type MachineHistory } from "./history-points";

interface Props {
  name: string;
  history: MachineHistory;
  /** History of another machine, in the same plot. */
  beside: MachineHistory | undefined;
  kinds: string[];
  markers: Marker[];
  /** Null where nothing is tested. */
  tests: TrendTest[] | null;
  xRange: [number, number] | undefined;
  height: number;
}

export function ParameterHistory({ name, history, beside, kinds, markers, tests, xRange, height }: Props) {
  const { series } = history;
  const histories = beside ? [history, beside] : [history];
  const points = historyPoints(histories);
  const sizes = histories.flatMap((one) => one.series.value.filter((value) => value !== null).map(Math.abs));
  const scale = scaleOf(Math.max(0, ...sizes), series.unit, useUnits());
  // Two machines may have been measured at the same instant.
  const readOut = (index: number) => atOnce(points, index).map((one) => pointText(one, scale)).join("; ");
  const isThinned = series.down_sampling && series.down_sampling.method !== "none";
  const onPick = (index: number) => openIdentification(points[index]!);
  return (
    <figure class="history-plot">
      <figcaption>
        <strong>{name}</strong> [{scale.unit || "-"}]
        {isThinned && <span class="muted"> {t("thinnedPoints", { points: series.down_sampling!.points })}</span>}
      </figcaption>
      {tests && <p class="trend-tests">{trendTestTexts(series.parameter, tests).join("; ")}</p>}
      <Plot
        label={t("parameterOverTime", { parameter: series.parameter, points: points.length })}
        x={points.map(seconds)}
        time
        yUnit={scale.unit}
        curves={histories.flatMap((one, place) => historyCurves(one, kinds, place * kinds.length, scale).map((curve) => overAll(curve, one, points)))}
        markers={markers}
        bands={baselineBands(series, scale)}
        {...(xRange ? { xRange } : {})}
        syncGroup="trends"
        height={height}
        readOut={readOut}
        onPick={onPick}
      />
      {series.real && <AngleHistoryPlot histories={histories} points={points} kinds={kinds} markers={markers} xRange={xRange} readOut={readOut} onPick={onPick} />}
    </figure>
  );
}

function openIdentification({ of, at }: HistoryPoint): void {
  navigate(["machines", of.machine, "identified"], { identification: String(of.series.identification[at]!) });
}

/** A curve for each kind of run, in colours from a number on, and one of what was not accepted. */
function historyCurves(history: MachineHistory, kinds: string[], colour: number, scale: Scale): Curve[] {
  const { series } = history;
  const filtered = (values: (number | null)[], keep: (index: number) => boolean) =>
    values.map((one, index) => (keep(index) ? scaled(one, scale) : null));
  const curves = kinds.map((kind, index): Curve => {
    const keep = (at: number) => series.run_kind[at] === kind && series.quality[at] === "accepted";
    const [y, lower, upper] = [series.value, series.lower, series.upper].map((column) => filtered(column, keep));
    return { name: curveName(history, kind), style: colour + index, y: y!, lower: lower!, upper: upper!, points: true, spanGaps: true };
  });
  if (series.quality.some((one) => one === "not_accepted")) {
    const y = filtered(series.value, (at) => series.quality[at] === "not_accepted");
    const name = `${t("pointNotAccepted")}${history.named ? t("ofMachine", { machine: history.machine }) : ""}`;
    curves.push({ name, y, faint: true, points: true, line: false });
  }
  return curves;
}

function baselineBands(series: Series, scale: Scale): Band[] {
  return series.baselines.map((one) => ({
    low: one.lower * scale.factor,
    high: one.upper * scale.factor,
    from: Date.parse(one.since) / 1000,
    to: one.until === null ? null : Date.parse(one.until) / 1000,
  }));
}

/** The text that is read out at a point. */
function pointText(point: HistoryPoint, scale: Scale): string {
  const { of, at: index } = point;
  const { series } = of;
  const value = series.value[index];
  const at = `${pointHead(point)} ${term(series.run_kind[index]!)}`;
  if (value === null || value === undefined) return t("notEstimableAt", { at });
  const low = scaled(series.lower[index], scale);
  const high = scaled(series.upper[index], scale);
  const baseline = baselineAt(series, index);
  const change = baseline && !isCrossCoupled(series.parameter) ? `, ${percent(value / baseline.centre - 1)}` : "";
  const quality = series.quality[index] === "accepted" ? "" : t("notAccepted");
  const angle = angleText(series.angle_deg?.[index] ?? null, series.angle_half_width_deg?.[index] ?? null);
  return `${at}: ${number(scaled(value, scale), 4)} (${number(low)} … ${number(high)}) ${scale.unit}${angle}${change}${quality}`;
}

/** The baseline that a point is compared with. */
function baselineAt(series: Series, index: number): BaselineBand | undefined {
  const at = series.measured_at[index]!;
  return series.baselines.find((one) => one.run_kind === series.run_kind[index] && one.since <= at && (one.until === null || at < one.until));
}
