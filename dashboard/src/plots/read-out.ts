// The text that a plot reads out at its cursor: each curve's value at the nearest point it has, whatever lies between.
import type { DataColumn } from "../browser/download";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import type { Curve, PlotProps } from "./plot-props";

/** The curves that are in the legend and read out. */
export function listedCurves<T extends Pick<Curve, "faint" | "unlisted">>(curves: T[]): T[] {
  return curves.filter((one) => !one.faint && !one.unlisted);
}

/** Rows that can be read out, one at each x: all of them where a plot has its own text. */
export function readableRows({ x, curves, readOut }: PlotProps): number[] {
  const listed = listedCurves(curves);
  const rows = x.map((_, row) => row).filter((row) => readOut || listed.some(({ y }) => hasValue(y, row)));
  return rows.filter((row, place) => place === 0 || x[row] !== x[rows[place - 1]!]);
}

/** Every curve's value at the readable row nearest to a row. */
export function valuesText(props: PlotProps, row: number): string {
  const { x, curves, xUnit = "", yUnit } = props;
  const readable = nearestRow(x, readableRows(props), row) ?? row;
  const values = listedCurves(curves).flatMap(({ name, y }) => {
    const row = nearestRow(x, x.map((_, at) => at).filter((at) => hasValue(y, at)), readable);
    return row === undefined ? [] : [`${name} ${props.turn ? Math.round(withinTurn(y[row]!, props.turn)) % props.turn : number(y[row])}`];
  });
  return `${number(x[readable], 4)} ${xUnit}: ${values.length > 0 ? `${values.join(", ")} ${yUnit}` : t("noValues")}`;
}

/** An angle without whole turns. */
export function withinTurn(value: number, turn: number): number {
  return ((value % turn) + turn) % turn;
}

/** A plot's data as columns of a file: x, and every curve with its bounds. */
export function dataColumns({ x, curves, time, xUnit, yUnit, turn }: PlotProps): DataColumn[] {
  const first = time ? { name: t("csvTime"), values: x.map((one) => new Date(one * 1000).toISOString()) } : { name: `x [${xUnit ?? ""}]`, values: x };
  const withoutTurns = (values: (number | null)[]) => (turn ? values.map((one) => (one === null ? null : withinTurn(one, turn))) : values);
  return [
    first,
    ...curves.flatMap(({ name, y, lower, upper }) => [
      { name: `${name} [${yUnit}]`, values: withoutTurns(y) },
      ...(lower && upper ? [{ name: t("lowerBound", { name, unit: yUnit }), values: lower }, { name: t("upperBound", { name, unit: yUnit }), values: upper }] : []),
    ]),
  ];
}

function hasValue(y: (number | null)[], row: number): boolean {
  return (y[row] ?? null) !== null;
}

/** The one of some rows whose x is nearest to that of a row. */
export function nearestRow(x: number[], rows: number[], row: number): number | undefined {
  let found: number | undefined;
  for (const one of rows) {
    if (found === undefined || Math.abs(x[one]! - x[row]!) < Math.abs(x[found]! - x[row]!)) found = one;
  }
  return found;
}

/** Characters of a value that is read out, with its separators; and of a line on a phone. */
const VALUE = 9;
const LINE = 48;

/** Lines that a read-out may take on a phone: their place is kept, so that plots below do not move. */
export function readOutLines({ readOut, curves, yUnit }: PlotProps): number {
  if (readOut) return 2;
  const lengths = listedCurves(curves).map((one) => one.name.length + VALUE);
  return Math.max(2, Math.ceil((VALUE + yUnit.length + lengths.reduce((sum, one) => sum + one, 0)) / LINE));
}
