// What a plot says at its cursor: each curve's value at the nearest point it has, whatever else lies between.
import { number } from "../words/format";
import type { Curve, PlotProps } from "./plot";

/** Of the curves, those that are named above the plot and read out. */
export function named<T extends Pick<Curve, "faint" | "aside">>(curves: T[]): T[] {
  return curves.filter((one) => !one.faint && !one.aside);
}

/** Rows that are read out, one at each x: all of them where a plot has its own words. */
export function stops({ x, curves, readOut }: PlotProps): number[] {
  const told = named(curves);
  const rows = x.map((_, row) => row).filter((row) => readOut || told.some(({ y }) => has(y, row)));
  return rows.filter((row, place) => place === 0 || x[row] !== x[rows[place - 1]!]);
}

/** Every curve's value at the point that is read out nearest to a row. */
export function values(props: PlotProps, row: number): string {
  const { x, curves, xUnit = "", yUnit } = props;
  const stop = nearestOf(x, stops(props), row) ?? row;
  const said = named(curves).flatMap(({ name, y }) => {
    const row = nearestOf(x, x.map((_, at) => at).filter((at) => has(y, at)), stop);
    return row === undefined ? [] : [`${name} ${number(y[row])}`];
  });
  return `${number(x[stop], 4)} ${xUnit}: ${said.length > 0 ? `${said.join(", ")} ${yUnit}` : "no values"}`;
}

function has(y: (number | null)[], row: number): boolean {
  return (y[row] ?? null) !== null;
}

/** Of some rows the one whose x is nearest to that of a row. */
export function nearestOf(x: number[], rows: number[], row: number): number | undefined {
  let found: number | undefined;
  for (const one of rows) {
    if (found === undefined || Math.abs(x[one]! - x[row]!) < Math.abs(x[found]! - x[row]!)) found = one;
  }
  return found;
}
