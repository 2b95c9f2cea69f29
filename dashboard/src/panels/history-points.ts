// The points of a parameter's histories of one or two machines on one axis of time.
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import type { Curve } from "../plots/plot-props";
import type { Series } from "../schemas/trends";

/** A machine's history of one parameter; named where another one is in the same plot. */
export interface MachineHistory {
  series: Series;
  machine: string;
  named: boolean;
}

/** A point of a history, by its place in it. */
export interface HistoryPoint {
  of: MachineHistory;
  at: number;
}

/** All points, the oldest first. */
export function historyPoints(histories: MachineHistory[]): HistoryPoint[] {
  const all = histories.flatMap((of) => of.series.measured_at.map((_, at): HistoryPoint => ({ of, at })));
  return histories.length > 1 ? all.sort((one, other) => seconds(one) - seconds(other)) : all;
}

/** Seconds since 1970 of a point. */
export function seconds({ of, at }: HistoryPoint): number {
  return Date.parse(of.series.measured_at[at]!) / 1000;
}

/** A point and all of the same instant. */
export function atOnce(points: HistoryPoint[], index: number): HistoryPoint[] {
  return points.filter((one) => seconds(one) === seconds(points[index]!));
}

/** A curve over the points of one history as one over all points. */
export function overAll(curve: Curve, of: MachineHistory, points: HistoryPoint[]): Curve {
  if (points.length === of.series.measured_at.length) return curve;
  const placed = (values: (number | null)[]) => points.map((one) => (one.of === of ? (values[one.at] ?? null) : null));
  return { ...curve, y: placed(curve.y), ...(curve.lower && curve.upper ? { lower: placed(curve.lower), upper: placed(curve.upper) } : {}) };
}

/** The name of the curve of a kind of run. */
export function curveName({ machine, named }: Pick<MachineHistory, "machine" | "named">, kind: string): string {
  return named ? `${term(kind)}${t("ofMachine", { machine })}` : term(kind);
}

/** The beginning of what is read out at a point: of which machine it is, where there are two, and when it was measured. */
export function pointHead({ of, at }: HistoryPoint): string {
  return `${of.named ? `${of.machine}, ` : ""}${when(of.series.measured_at[at]!)}`;
}
