// A run over speed: measured points, the identified model's curve with its band, another run, and what is left.
import type { Bode, Document, MeasuredRun } from "../schemas/answers";
import { beside, onCommonAxis, unwrapped, type Group } from "../plots/common-axis";
import { Empty, Panel } from "../components/parts";
import { Plot, type Curve } from "../plots/plot";
import { Polar, type PolarCurve } from "../plots/polar-plot";
import type { Sweep } from "../data/speed-sweep";

export interface Shown {
  machine: Document;
  channels: string[];
  measured: Sweep;
  reference: Sweep | undefined;
  fit: Bode | undefined;
  /** Why there is none. */
  noFit: string;
  /** What points and curve are without. */
  slowRoll: string;
}

/** One channel of a run, ascending in speed. */
interface Points {
  rpm: number[];
  amplitude: (number | null)[];
  lag: (number | null)[];
}

function pointsOf(sweep: Sweep, channel: string): Points {
  const row = sweep.channels.indexOf(channel);
  return { rpm: sweep.rpm, amplitude: sweep.amplitude[row] ?? [], lag: sweep.lag[row] ?? [] };
}

export function Response(shown: Shown) {
  const { machine, channels } = shown;
  const range: [number, number] = [machine.speed_range.minimum_rpm, machine.speed_range.maximum_rpm];
  const amplitude = lines(shown, "amplitude");
  const phase = lines(shown, "lag");
  const unknown = shown.fit ? channels.filter((channel) => !fittedOf(shown, channel)) : [];
  return (
    <>
      <Panel title="Bode" aside={<Key {...shown} />}>
        {unknown.length > 0 && <p class="muted">The identification of this run does not know {unknown.join(", ")}: there is no curve, and nothing is left over.</p>}
        <Plot label={`Amplitude of ${channels.join(", ")} over speed`} {...amplitude} xUnit="rpm" yUnit="µm pp" xRange={range} together="bode" height={270} />
        <Plot label={`Phase lag of ${channels.join(", ")} over speed`} {...phase} xUnit="rpm" yUnit="° lag" xRange={range} together="bode" height={190} />
        <Residuals {...shown} range={range} />
      </Panel>
      <Panel title="Polar" aside={<p class="muted">Lag grows clockwise from the right; speeds in rpm; {shown.slowRoll}.</p>}>
        <div class="polars">
          {channels.map((channel, style) => (
            <Polar key={channel} title={channel} curves={polarCurves(shown, channel, style)} />
          ))}
        </div>
      </Panel>
    </>
  );
}

function fittedOf({ fit }: Shown, channel: string): Bode["fitted"]["channels"][number] | undefined {
  return fit?.fitted.channels.find((one) => one.channel === channel);
}

function Key({ fit, reference, slowRoll }: Shown) {
  const said = ["● measured", ...(fit ? ["— the model with its 95 % band"] : []), ...(reference ? ["○ the other run"] : [])];
  return <p class="muted">{said.join("  ")}; {slowRoll}.</p>;
}

function lines(shown: Shown, what: "amplitude" | "lag"): { x: number[]; curves: Curve[] } {
  const groups: Group[] = [];
  const made: ((columns: (number | null)[][]) => Curve)[] = [];
  const add = (x: number[], columns: (number | null)[][], curve: (columns: (number | null)[][]) => Curve) => {
    groups.push({ x, columns });
    made.push(curve);
  };
  shown.channels.forEach((channel, style) => {
    const fitted = fittedOf(shown, channel);
    const speeds = shown.fit?.fitted.speed ?? [];
    const curve = fitted && what === "lag" ? unwrapped(fitted.phase) : fitted?.amplitude;
    const near = (points: Points) => (what === "amplitude" ? points.amplitude : curve ? beside(points.rpm, points.lag, speeds, curve) : points.lag);
    if (shown.reference) {
      const points = pointsOf(shown.reference, channel);
      add(points.rpm, [near(points)], ([y]) => ({ name: `${channel}, other run`, y: y!, faint: true, points: true, line: false }));
    }
    if (fitted && curve) {
      const band = what === "amplitude" ? [fitted.lower, fitted.upper] : [];
      add(speeds, [curve, ...band], ([y, lower, upper]) => ({ name: `${channel}, model`, style, y: y!, ...(lower && upper ? { lower, upper } : {}), spans: true, aside: true }));
    }
    const points = pointsOf(shown.measured, channel);
    add(points.rpm, [near(points)], ([y]) => ({ name: channel, style, y: y!, points: true, line: !fitted && what === "amplitude", spans: true }));
  });
  const { x, columns } = onCommonAxis(groups);
  return { x, curves: columns.map((one, at) => made[at]!(one)) };
}

function Residuals({ fit, noFit, channels, range }: Shown & { range: [number, number] }) {
  const run: MeasuredRun | undefined = fit?.measured[0];
  if (!run) return <Empty>{noFit}</Empty>;
  const order = run.speed.map((_, at) => at).sort((a, b) => run.speed[a]! - run.speed[b]!);
  const rows = channels.flatMap((channel, style) => run.channels.filter((one) => one.channel === channel).map((one) => ({ ...one, style })));
  const known = rows.some((one) => one.residual_sigma.some((value) => value !== null));
  const curves = rows.flatMap((one): Curve[] => {
    const values = known ? one.residual_sigma : one.residual;
    const of = (used: boolean) => order.map((at) => (one.used[at] === used ? (values[at] ?? null) : null));
    return [
      { name: `${one.channel}, left out`, y: of(false), faint: true, points: true, line: false },
      { name: one.channel, style: one.style, y: of(true), points: true, line: false },
    ];
  });
  return (
    <Plot
      label="Residuals over speed"
      x={order.map((at) => run.speed[at]!)}
      curves={curves}
      xUnit="rpm"
      yUnit={known ? "residual, σ" : "residual, µm pp"}
      xRange={range}
      together="bode"
      height={130}
    />
  );
}

function polarCurves(shown: Shown, channel: string, style: number): PolarCurve[] {
  const curves: PolarCurve[] = [];
  if (shown.reference) curves.push({ name: `${channel}, other run`, style, line: false, faint: true, ...pointsOf(shown.reference, channel) });
  const fitted = fittedOf(shown, channel);
  if (fitted) curves.push({ name: `${channel}, model`, style, line: true, unlabelled: true, rpm: shown.fit!.fitted.speed, amplitude: fitted.amplitude, lag: fitted.phase });
  curves.push({ name: channel, style, line: false, ...pointsOf(shown.measured, channel) });
  return curves;
}
