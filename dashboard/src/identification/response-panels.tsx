// The response of a run over speed as Bode and polar plots: measured points, the model's curve with its band, an overlaid run.
import { Empty, Panel } from "../components/panel";
import type { SpeedSweep } from "../data/speed-sweep";
import { mergeOnCommonAxis, type Group } from "../plots/common-axis";
import { nearestTurns, unwrapPhase } from "../plots/phase";
import { Plot } from "../plots/plot";
import type { Curve } from "../plots/plot-props";
import type { PolarCurve } from "../plots/polar-geometry";
import { PolarPlot } from "../plots/polar-plot";
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
}

type Column = (number | null)[];

/** One channel of a run, ascending in speed. */
interface Points {
  rpm: number[];
  amplitude: Column;
  lag: Column;
}

export function ResponsePanels(props: ResponseProps) {
  const { machine, channels } = props;
  const range: [number, number] = [machine.speed_range.minimum_rpm, machine.speed_range.maximum_rpm];
  const unfitted = props.fit ? channels.filter((channel) => !fittedOf(props, channel)) : [];
  return (
    <>
      <Panel title="Bode" aside={<Legend {...props} />}>
        {unfitted.length > 0 && <p class="muted">The identification of this run does not include {unfitted.join(", ")}: there is no curve and no residual.</p>}
        <Plot label={`Amplitude of ${channels.join(", ")} over speed`} {...bodeCurves(props, "amplitude")} xUnit="rpm" yUnit="µm pp" xRange={range} syncGroup="bode" height={270} />
        <Plot label={`Phase lag of ${channels.join(", ")} over speed`} {...bodeCurves(props, "lag")} xUnit="rpm" yUnit="° lag" xRange={range} syncGroup="bode" height={190} />
        <Residuals {...props} range={range} />
      </Panel>
      <Panel title="Polar" aside={<p class="muted">Phase lag increases clockwise from the right; speeds in rpm; {props.slowRoll}.</p>}>
        <div class="polars">
          {channels.map((channel, style) => (
            <PolarPlot key={channel} title={channel} curves={polarCurves(props, channel, style)} />
          ))}
        </div>
      </Panel>
    </>
  );
}

function Legend({ fit, reference, slowRoll }: ResponseProps) {
  const signs = ["● measured", ...(fit ? ["— model with 95 % band"] : []), ...(reference ? ["○ overlaid run"] : [])];
  return <p class="muted">{signs.join("  ")}; {slowRoll}.</p>;
}

function pointsOf(sweep: SpeedSweep, channel: string): Points {
  const row = sweep.channels.indexOf(channel);
  return { rpm: sweep.rpm, amplitude: sweep.amplitude[row] ?? [], lag: sweep.lag[row] ?? [] };
}

function fittedOf({ fit }: ResponseProps, channel: string): Bode["fitted"]["channels"][number] | undefined {
  return fit?.fitted.channels.find((one) => one.channel === channel);
}

/** A curve's own columns, and the curve made of them once they are on the common axis. */
interface PendingCurve extends Group {
  curve: (columns: Column[]) => Curve;
}

function bodeCurves(props: ResponseProps, what: "amplitude" | "lag"): { x: number[]; curves: Curve[] } {
  const pending = props.channels.flatMap((channel, style) => channelCurves(props, channel, style, what));
  const { x, columns } = mergeOnCommonAxis(pending);
  return { x, curves: columns.map((one, at) => pending[at]!.curve(one)) };
}

/** The curves of a channel: overlaid run, model, measured points. Phases are put beside the model's curve. */
function channelCurves(props: ResponseProps, channel: string, style: number, what: "amplitude" | "lag"): PendingCurve[] {
  const fitted = fittedOf(props, channel);
  const speeds = props.fit?.fitted.speed ?? [];
  const model = fitted && what === "lag" ? unwrapPhase(fitted.phase) : fitted?.amplitude;
  const valuesOf = (points: Points) => (what === "amplitude" ? points.amplitude : model ? nearestTurns(points.rpm, points.lag, speeds, model) : points.lag);
  const curves: PendingCurve[] = [];
  if (props.reference) {
    const points = pointsOf(props.reference, channel);
    curves.push({ x: points.rpm, columns: [valuesOf(points)], curve: ([y]) => ({ name: `${channel}, overlaid run`, y: y!, faint: true, points: true, line: false }) });
  }
  if (fitted && model) {
    const band = what === "amplitude" ? [fitted.lower, fitted.upper] : [];
    const curve = ([y, lower, upper]: Column[]): Curve => ({ name: `${channel}, model`, style, y: y!, ...(lower && upper ? { lower, upper } : {}), spanGaps: true, unlisted: true });
    curves.push({ x: speeds, columns: [model, ...band], curve });
  }
  const points = pointsOf(props.measured, channel);
  const line = !fitted && what === "amplitude";
  curves.push({ x: points.rpm, columns: [valuesOf(points)], curve: ([y]) => ({ name: channel, style, y: y!, points: true, line, spanGaps: true }) });
  return curves;
}

function Residuals({ fit, noFit, channels, range }: ResponseProps & { range: [number, number] }) {
  const run: MeasuredRun | undefined = fit?.measured[0];
  if (!run) return <Empty>{noFit}</Empty>;
  const order = run.speed.map((_, at) => at).sort((a, b) => run.speed[a]! - run.speed[b]!);
  const rows = channels.flatMap((channel, style) => run.channels.filter((one) => one.channel === channel).map((one) => ({ ...one, style })));
  const isStandardised = rows.some((one) => one.residual_sigma.some((value) => value !== null));
  const curves = rows.flatMap((one): Curve[] => {
    const values = isStandardised ? one.residual_sigma : one.residual;
    const of = (used: boolean) => order.map((at) => (one.used[at] === used ? (values[at] ?? null) : null));
    return [
      { name: `${one.channel}, excluded`, y: of(false), faint: true, points: true, line: false },
      { name: one.channel, style: one.style, y: of(true), points: true, line: false },
    ];
  });
  return (
    <Plot
      label="Residuals over speed"
      x={order.map((at) => run.speed[at]!)}
      curves={curves}
      xUnit="rpm"
      yUnit={isStandardised ? "residual, σ" : "residual, µm pp"}
      xRange={range}
      syncGroup="bode"
      height={130}
    />
  );
}

function polarCurves(props: ResponseProps, channel: string, style: number): PolarCurve[] {
  const curves: PolarCurve[] = [];
  if (props.reference) curves.push({ name: `${channel}, overlaid run`, style, line: false, faint: true, ...pointsOf(props.reference, channel) });
  const fitted = fittedOf(props, channel);
  if (fitted) curves.push({ name: `${channel}, model`, style, line: true, unlabelled: true, rpm: props.fit!.fitted.speed, amplitude: fitted.amplitude, lag: fitted.phase });
  curves.push({ name: channel, style, line: false, ...pointsOf(props.measured, channel) });
  return curves;
}
