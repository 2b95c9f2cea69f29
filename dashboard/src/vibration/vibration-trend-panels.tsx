// 1×, 2× and 2×/1× at running speed, run by run, with the machine's limits, and the vectors in their acceptance regions.
import { inUnit, useUnits, type Unit } from "../browser/units";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Speed } from "../components/speed";
import { queryString } from "../data/http-client";
import { useResource } from "../data/resource";
import { number } from "../format/numbers";
import { when } from "../format/times";
import { rich, t, term } from "../messages/messages";
import { CurveLegend } from "../plots/curve-legend";
import { unwrapPhase } from "../plots/phase";
import { Plot } from "../plots/plot";
import type { Curve, LimitLine } from "../plots/plot-props";
import type { PolarCurve } from "../plots/polar-geometry";
import { PolarPlot } from "../plots/polar-plot";
import { withinTurn } from "../plots/read-out";
import type { Document } from "../schemas/machines";
import type { ProbeTrend, VibrationLimits, VibrationTrend } from "../schemas/vibration";
import { slowRollText } from "../words/slow-roll";
import { zoneBoundaries, zonesText } from "../words/vibration-limits";

const POLL_MS = 30_000;

interface Props {
  machine: Document;
  channels: string[];
  /** Kind of the runs that are shown; null for that of the newest. */
  kind: string | null;
  from: string | null;
  to: string | null;
}

export function VibrationTrendPanels(props: Props) {
  const query = queryString({ slow_roll: "in_force", limit: 400, from: props.from, to: props.to });
  const result = useResource<VibrationTrend>(`/machines/${props.machine.id}/vibration/trend${query}`, POLL_MS);
  return (
    <Loaded result={result} lines={30}>
      {(found) => (found.probes[0]?.run.length ? <Panels {...props} found={found} /> : <NoRuns found={found} />)}
    </Loaded>
  );
}

function NoRuns({ found }: { found: VibrationTrend }) {
  return (
    <Panel title={t("atRunningSpeed")}>
      <Empty>
        {t("noRunOfThisPeriod")}{found.running_rpm !== null && <>, <Speed rpm={found.running_rpm} /></>}.
      </Empty>
    </Panel>
  );
}

/** The runs of one kind, of the channels shown. */
function Panels({ machine, channels, kind, found }: Props & { found: VibrationTrend }) {
  const { amplitude, length } = useUnits();
  const shownKind = kind ?? found.probes[0]!.run_kind.at(-1)!;
  const probes = found.probes.filter((one) => channels.includes(one.channel)).map((one) => ofKind(one, shownKind));
  const limits = limitLines(found.limits, amplitude);
  return (
    <>
      <Panel title={t("atRunningSpeedKind", { kind: term(shownKind) })} aside={<Basis found={found} />}>
        <CurveLegend curves={probes.map(({ channel }) => ({ name: channel }))} />
        <div class="plots">
          <Trend what={t("n1Amplitude")} probes={probes} unit={amplitude.label} column={(one) => inUnit(one.amplitude_um_pp, amplitude)} limits={limits} />
          <Trend what={t("n1Phase")} probes={probes} unit={t("degreesLag")} column={(one) => unwrapPhase(one.phase_lag_deg)} turn={360} />
          <Trend what={t("n2Amplitude")} probes={probes} unit={amplitude.label} column={(one) => inUnit(one.amplitude_2x_um_pp, amplitude)} />
          <Trend what={t("n2Over1")} probes={probes} unit="2×/1×" column={(one) => one.second_over_first} />
          <Trend what={t("overallLevel")} probes={probes} unit={amplitude.label} column={(one) => inUnit(one.overall_um_pp, amplitude)} limits={zoneLines(found.limits, amplitude)} />
          <Trend what={t("gap")} probes={probes} unit={length.label} column={(one) => inUnit(one.gap_um, length)} />
        </div>
        <p class="muted">{zonesText(found.limits.severity_zones, amplitude)}</p>
      </Panel>
      <Panel title={t("n1VectorsAndAcceptanceRegions")} aside={<p class="muted">{t("phaseLagIncreasesClockwiseFrom")}</p>}>
        <p class="muted">
          {t("acceptanceExplained", { runs: found.probes[0]!.regions[0]?.runs ?? t("fewRuns") })}
        </p>
        <div class="polars">
          {probes.map((one, style) => (
            <figure key={one.channel}>
              <PolarPlot title={one.channel} curves={vectorCurves(one, style, amplitude)} unit={amplitude.label} />
              <p class="muted">{regionText(one)}</p>
            </figure>
          ))}
        </div>
        {machine.probes.length > probes.length && <p class="muted">{t("chosenOfProbes", { count: machine.probes.length })}</p>}
      </Panel>
    </>
  );
}

function Basis({ found }: { found: VibrationTrend }) {
  return (
    <p class="muted">
      {rich("meanVectors", { speed: <Speed rpm={found.running_rpm} />, named: !found.running_speed_named && t("toWhichAllOfThe"), slow_roll: slowRollText(found.slow_roll_version, Object.keys(found.slow_roll_left_out)) })}
    </p>
  );
}

type TrendColumn = Exclude<{ [Name in keyof ProbeTrend]: ProbeTrend[Name] extends unknown[] ? Name : never }[keyof ProbeTrend], "regions">;
const COLUMNS: TrendColumn[] = ["run", "run_kind", "measured_at", "speed_rpm", "amplitude_um_pp", "phase_lag_deg", "amplitude_2x_um_pp", "phase_2x_lag_deg", "second_over_first", "overall_um_pp", "zone", "gap_um", "within"];

function ofKind(probe: ProbeTrend, kind: string): ProbeTrend {
  const kept = probe.run_kind.flatMap((one, at) => (one === kind ? [at] : []));
  const columns = COLUMNS.map((name) => [name, kept.map((at) => probe[name][at])]);
  return { ...probe, ...(Object.fromEntries(columns) as Pick<ProbeTrend, TrendColumn>), regions: probe.regions.filter((one) => one.run_kind === kind) };
}

function limitLines(limits: VibrationLimits, unit: Unit): LimitLine[] {
  const named: [LimitLine["kind"], number | null][] = [["alert", limits.alert_um_pp], ["danger", limits.danger_um_pp], ["note", limits.balanced_um_pp]];
  return named.flatMap(([kind, value]) => (value === null ? [] : [{ y: value * unit.factor, kind, words: kind === "note" ? t("balancedLimit") : term(kind) }]));
}

function zoneLines({ severity_zones: zones }: VibrationLimits, unit: Unit): LimitLine[] {
  return zoneBoundaries(zones).map(([name, value]): LimitLine => ({ y: value * unit.factor, kind: "note", words: name }));
}

interface TrendProps {
  what: string;
  probes: ProbeTrend[];
  unit: string;
  column: (one: ProbeTrend) => (number | null)[];
  limits?: LimitLine[];
  turn?: number;
}

function Trend({ what, probes, unit, column, limits, turn }: TrendProps) {
  const x = (probes[0]?.measured_at ?? []).map((one) => Date.parse(one) / 1000);
  const curves = probes.map((one): Curve => ({ name: one.channel, y: column(one), points: true, spanGaps: true }));
  if (curves.every(({ y }) => y.every((value) => value === null))) {
    return (
      <figure>
        <figcaption>
          <strong>{what}</strong>
        </figcaption>
        <Empty>{t("sourcesSendNone")}</Empty>
      </figure>
    );
  }
  const valueText = (value: number | null) => (value === null ? "–" : turn ? String(Math.round(withinTurn(value, turn)) % turn) : number(value));
  const readOut = (at: number) => `${when(probes[0]!.measured_at[at]!)}: ${curves.map(({ name, y }) => `${name} ${valueText(y[at] ?? null)}`).join(", ")} ${unit}`;
  return (
    <figure>
      <figcaption>
        <strong>{what}</strong>
      </figcaption>
      <Plot
        label={t("atRunningSpeedOverTime", { what, runs: x.length })}
        x={x}
        time
        yUnit={unit}
        curves={curves}
        {...(limits ? { limits } : {})}
        {...(turn ? { turn } : {})}
        syncGroup="vibration"
        height={170}
        readOut={readOut}
      />
    </figure>
  );
}

/** All runs as points, the region, and the newest run as an arrow. */
function vectorCurves(probe: ProbeTrend, style: number, unit: Unit): PolarCurve[] {
  const amplitude = inUnit(probe.amplitude_um_pp, unit);
  const [region] = probe.regions;
  const last = amplitude.findLastIndex((one) => one !== null);
  const points: PolarCurve = { name: t("runs"), style, rpm: probe.speed_rpm, amplitude, lag: probe.phase_lag_deg, line: false, unlabelled: true };
  if (region) {
    points.region = {
      real: region.centre_real_um_pp * unit.factor,
      imaginary: region.centre_imaginary_um_pp * unit.factor,
      semiMajor: region.semi_major_um_pp * unit.factor,
      semiMinor: region.semi_minor_um_pp * unit.factor,
      inclinationDeg: region.inclination_deg,
    };
  }
  if (last < 0) return [points];
  const arrow: PolarCurve = { name: t("newestRun"), style: 1, rpm: [0, 0], amplitude: [0, amplitude[last]!], lag: [probe.phase_lag_deg[last]!, probe.phase_lag_deg[last]!], line: true, vector: true };
  return [points, arrow];
}

/** Text on the runs that have a vector at this probe; others are left out. */
function regionText({ within, regions }: ProbeTrend): string {
  if (regions.length === 0) return t("noRegionYetTheBaseline");
  const known = within.filter((one) => one !== null);
  if (known.length === 0) return t("noGoodValue");
  const outside = known.filter((one) => !one).length;
  const newest = known.at(-1) ? t("theNewestRunLiesWithin") : t("theNewestRunLiesOutside");
  return outside > 0 ? t("runsOutside", { newest, outside, all: known.length }) : newest;
}
