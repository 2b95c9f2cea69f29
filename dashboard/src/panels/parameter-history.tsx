// The history of one parameter: its estimates with intervals, the baseline's band, and the results of its trend tests.
import { navigate, route } from "../browser/router";
import { angleText } from "../format/angles";
import { isCrossCoupled } from "../format/names";
import { number, percent, scaleOf, type Scale } from "../format/numbers";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { Band, Curve, Marker } from "../plots/plot-props";
import type { BaselineBand, Series, TrendTest } from "../schemas/trends";
import { trendTestTexts } from "../words/trend-tests";
import { AngleHistoryPlot } from "./angle-history-plot";

interface Props {
  name: string;
  series: Series;
  kinds: string[];
  markers: Marker[];
  /** Null where nothing is tested. */
  tests: TrendTest[] | null;
  xRange: [number, number] | undefined;
  height: number;
}

export function ParameterHistory({ name, series, kinds, markers, tests, xRange, height }: Props) {
  const sizes = series.value.filter((one) => one !== null).map(Math.abs);
  const scale = scaleOf(Math.max(0, ...sizes), series.unit);
  const readOut = (index: number) => pointText(series, index, scale);
  const isThinned = series.down_sampling && series.down_sampling.method !== "none";
  const onPick = (index: number) => openIdentification(series.identification[index]!);
  return (
    <figure class="history-plot">
      <figcaption>
        <strong>{name}</strong> [{scale.unit || "-"}]
        {isThinned && <span class="muted"> {t("thinnedPoints", { points: series.down_sampling!.points })}</span>}
      </figcaption>
      {tests && <p class="trend-tests">{trendTestTexts(series.parameter, tests).join("; ")}</p>}
      <Plot
        label={t("parameterOverTime", { parameter: series.parameter, points: series.value.length })}
        x={series.measured_at.map((one) => Date.parse(one) / 1000)}
        time
        yUnit={scale.unit}
        curves={historyCurves(series, kinds, scale)}
        markers={markers}
        bands={baselineBands(series, scale)}
        {...(xRange ? { xRange } : {})}
        syncGroup="trends"
        height={height}
        readOut={readOut}
        onPick={onPick}
      />
      {series.real && <AngleHistoryPlot series={series} kinds={kinds} markers={markers} xRange={xRange} readOut={readOut} onPick={onPick} />}
    </figure>
  );
}

function openIdentification(id: number): void {
  const machine = route.value.parts[1];
  if (machine) navigate(["machines", machine, "identified"], { identification: String(id) });
}

/** A curve for each kind of run, and one of what was not accepted. */
function historyCurves(series: Series, kinds: string[], scale: Scale): Curve[] {
  const filtered = (values: (number | null)[], keep: (index: number) => boolean) =>
    values.map((one, index) => (keep(index) ? scaled(one, scale) : null));
  const curves = kinds.map((kind, index): Curve => {
    const keep = (at: number) => series.run_kind[at] === kind && series.quality[at] === "accepted";
    const [y, lower, upper] = [series.value, series.lower, series.upper].map((column) => filtered(column, keep));
    return { name: term(kind), style: index, y: y!, lower: lower!, upper: upper!, points: true, spanGaps: true };
  });
  if (series.quality.some((one) => one === "not_accepted")) {
    const y = filtered(series.value, (at) => series.quality[at] === "not_accepted");
    curves.push({ name: t("pointNotAccepted"), y, faint: true, points: true, line: false });
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

function scaled(value: number | null | undefined, scale: Scale): number | null {
  return value === null || value === undefined ? null : value * scale.factor;
}

/** The text that is read out at a point. */
function pointText(series: Series, index: number, scale: Scale): string {
  const value = series.value[index];
  const at = `${when(series.measured_at[index]!)} ${term(series.run_kind[index]!)}`;
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
