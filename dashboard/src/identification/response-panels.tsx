// The response of a run over speed as Bode and polar plots: measured points, the model's curve with its band, an overlaid run.
import { inUnit, speedsInUnit, useUnits, type Units } from "../browser/units";
import { Empty, Panel } from "../components/panel";
import type { SpeedSweep } from "../data/speed-sweep";
import { t } from "../messages/messages";
import { mergeOnCommonAxis, type Group } from "../plots/common-axis";
import { nearestTurns, unwrapPhase } from "../plots/phase";
import { Plot } from "../plots/plot";
import type { Curve } from "../plots/plot-props";
import type { PolarCurve } from "../plots/polar-geometry";
import { PolarPlot } from "../plots/polar-plot";
import type { Column } from "../schemas/columns";
import type { Document } from "../schemas/machines";
import type { Bode, MeasuredRun } from "../schemas/model";

export interface ResponseProps {
  machine: Document;
  channels: string[];
  measured: SpeedSweep;
  reference: SpeedSweep | undefined;
  fit: Bode | undefined;
  /** Why there is none. */
  noFit: string;
  /** The slow roll that was subtracted from points and curve. */
  slowRoll: string;
  /** The model and the slow roll are of the 1× alone. */
  order: 1 | 2;
  /** Name of the overlaid run's machine, where it is another one. */
  overlaid?: string | undefined;
}

/** Properties with values in the chosen units. */
interface ShownResponseProps extends ResponseProps {
  units: Units;
}

/** One channel of a run, ascending in speed. */
interface Points {
  rpm: number[];
  amplitude: Column;
  lag: Column;
}

export function ResponsePanels(given: ResponseProps) {
  const props: ShownResponseProps = { ...given, units: useUnits() };
  const { machine, channels, order } = props;
  const { amplitude, speed } = props.units;
  const range: [number, number] = [machine.speed_range.minimum_rpm * speed.factor, machine.speed_range.maximum_rpm * speed.factor];
  const axes = { xUnit: speed.label, xRange: range, syncGroup: "bode" };
  if (order === 2 && !props.measured.second.some((one) => one.some((value) => value !== null))) {
    return (
      <Panel title={t("bode2")}>
        <Empty>{t("theSourcesOfThisMachine")}</Empty>
      </Panel>
    );
  }
  const unfitted = props.fit ? channels.filter((channel) => !fittedOf(props, channel)) : [];
  return (
    <>
      <Panel class="whole" title={t("bodeOfOrder", { order })} aside={<Legend {...props} />}>
        {order === 1 && unfitted.length > 0 && <p class="muted">{t("identificationLacksChannels", { channels: unfitted.join(", ") })}</p>}
        <Plot label={t("amplitudeOfOverSpeed", { channels: channels.join(", ") })} {...bodeCurves(props, "amplitude")} {...axes} yUnit={amplitude.label} height={270} />
        <Plot label={t("phaseLagOfOverSpeed", { channels: channels.join(", ") })} {...bodeCurves(props, "lag")} {...axes} yUnit={t("degreesLag")} turn={360} height={190} />
        {order === 1 && <Residuals {...props} range={range} />}
      </Panel>
      <Panel class="whole" title={t("polarOfOrder", { order })} aside={<p class="muted">{t("polarReading", { unit: speed.label, legend: slowRollOf(props) })}</p>}>
        <div class="polars">
          {channels.map((channel, style) => (
            <PolarPlot key={channel} title={channel} curves={polarCurves(props, channel, style)} unit={amplitude.label} speedUnit={speed.label} />
          ))}
        </div>
      </Panel>
    </>
  );
}

function Legend(props: ShownResponseProps) {
  const { fit, reference, order, overlaid } = props;
  const model = fit && order === 1 ? [t("modelWith95Band")] : [];
  const signs = [t("measuredPoints"), ...model, ...(reference ? [t("overlaidRunLegend", { of: overlaid ? t("ofMachine", { machine: overlaid }) : "" })] : [])];
  return (
    <p class="muted">
      {signs.join("  ")}; {slowRollOf(props)}.
    </p>
  );
}

function slowRollOf({ order, slowRoll }: ShownResponseProps): string {
  return order === 1 ? slowRoll : t("secondOrderAsMeasured");
}

/** The points of a channel; of another machine's run those of the channel of that name, else of the same place in its list. */
function pointsOf({ order, units, machine, overlaid }: ShownResponseProps, sweep: SpeedSweep, channel: string): Points {
  const named = sweep.channels.indexOf(channel);
  const row = named < 0 && overlaid ? machine.probes.findIndex((one) => one.id === channel) : named;
  const [amplitude, lag] = order === 1 ? [sweep.amplitude[row], sweep.lag[row]] : [sweep.second[row], sweep.secondLag[row]];
  return { rpm: speedsInUnit(sweep.rpm, units.speed), amplitude: inUnit(amplitude ?? [], units.amplitude), lag: lag ?? [] };
}

/** The model's curve of a channel, in the units shown; of the 1× alone. */
function fittedOf({ fit, order, units }: ShownResponseProps, channel: string): Bode["fitted"]["channels"][number] | undefined {
  const found = order === 1 ? fit?.fitted.channels.find((one) => one.channel === channel) : undefined;
  const shown = (column: Column) => inUnit(column, units.amplitude);
  return found && { ...found, amplitude: shown(found.amplitude), lower: shown(found.lower), upper: shown(found.upper) };
}

function fittedSpeeds({ fit, units }: ShownResponseProps): number[] {
  return speedsInUnit(fit?.fitted.speed ?? [], units.speed);
}

/** A curve's own columns, and the curve made of them once they are on the common axis. */
interface PendingCurve extends Group {
  curve: (columns: Column[]) => Curve;
}

function bodeCurves(props: ShownResponseProps, what: "amplitude" | "lag"): { x: number[]; curves: Curve[] } {
  const pending = props.channels.flatMap((channel, style) => channelCurves(props, channel, style, what));
  const { x, columns } = mergeOnCommonAxis(pending);
  return { x, curves: columns.map((one, at) => pending[at]!.curve(one)) };
}

/** The curves of a channel: overlaid run, model, measured points. Phases are put beside the model's curve. */
function channelCurves(props: ShownResponseProps, channel: string, style: number, what: "amplitude" | "lag"): PendingCurve[] {
  const fitted = fittedOf(props, channel);
  const speeds = fittedSpeeds(props);
  const model = fitted && what === "lag" ? unwrapPhase(fitted.phase) : fitted?.amplitude;
  const valuesOf = (points: Points) => (what === "amplitude" ? points.amplitude : model ? nearestTurns(points.rpm, points.lag, speeds, model) : points.lag);
  const curves: PendingCurve[] = [];
  if (props.reference) {
    const points = pointsOf(props, props.reference, channel);
    curves.push({ x: points.rpm, columns: [valuesOf(points)], curve: ([y]) => ({ name: t("overlaidRun", { channel }), y: y!, faint: true, points: true, line: false }) });
  }
  if (fitted && model) {
    const band = what === "amplitude" ? [fitted.lower, fitted.upper] : [];
    const curve = ([y, lower, upper]: Column[]): Curve => ({ name: t("channelModel", { channel }), style, y: y!, ...(lower && upper ? { lower, upper } : {}), spanGaps: true, unlisted: true });
    curves.push({ x: speeds, columns: [model, ...band], curve });
  }
  const points = pointsOf(props, props.measured, channel);
  const line = !fitted && what === "amplitude";
  curves.push({ x: points.rpm, columns: [valuesOf(points)], curve: ([y]) => ({ name: channel, style, y: y!, points: true, line, spanGaps: true }) });
  return curves;
}

function Residuals({ fit, noFit, channels, range, units }: ShownResponseProps & { range: [number, number] }) {
  const run: MeasuredRun | undefined = fit?.measured[0];
  if (!run) return <Empty>{noFit}</Empty>;
  const order = run.speed.map((_, at) => at).sort((a, b) => run.speed[a]! - run.speed[b]!);
  const rows = channels.flatMap((channel, style) => run.channels.filter((one) => one.channel === channel).map((one) => ({ ...one, style })));
  const isStandardised = rows.some((one) => one.residual_sigma.some((value) => value !== null));
  const curves = rows.flatMap((one): Curve[] => {
    const values = isStandardised ? one.residual_sigma : inUnit(one.residual, units.amplitude);
    const of = (used: boolean) => order.map((at) => (one.used[at] === used ? (values[at] ?? null) : null));
    return [
      { name: t("channelExcluded", { channel: one.channel }), y: of(false), faint: true, points: true, line: false },
      { name: one.channel, style: one.style, y: of(true), points: true, line: false },
    ];
  });
  return (
    <Plot
      label={t("residualsOverSpeed")}
      x={order.map((at) => run.speed[at]! * units.speed.factor)}
      curves={curves}
      xUnit={units.speed.label}
      yUnit={isStandardised ? t("residual") : t("residualIn", { unit: units.amplitude.label })}
      xRange={range}
      syncGroup="bode"
      height={130}
    />
  );
}

function polarCurves(props: ShownResponseProps, channel: string, style: number): PolarCurve[] {
  const curves: PolarCurve[] = [];
  const fitted = fittedOf(props, channel);
  // Without a model's curve between them, points are connected in the order of speed.
  const line = !fitted;
  if (props.reference) curves.push({ name: t("overlaidRun", { channel }), style, line, marked: true, faint: true, ...pointsOf(props, props.reference, channel) });
  if (fitted) curves.push({ name: t("channelModel", { channel }), style, line: true, unlabelled: true, rpm: fittedSpeeds(props), amplitude: fitted.amplitude, lag: fitted.phase });
  curves.push({ name: channel, style, line, marked: true, ...pointsOf(props, props.measured, channel) });
  return curves;
}
