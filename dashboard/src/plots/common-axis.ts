// Columns over different speeds merged on one axis, null where a column has no point.
import type { Column } from "../schemas/columns";

export interface Group {
  x: number[];
  columns: Column[];
}

/** The ascending union of all x, and each group's columns over it: where groups have the same x they share it. */
export function mergeOnCommonAxis(groups: Group[]): { x: number[]; columns: Column[][] } {
  const keys = groups.map(({ x }) => keysOf(x));
  const rows = new Map(groups.flatMap(({ x }, owner) => x.map((one, at) => [keys[owner]![at]!, one])));
  const all = [...rows].sort(([, one], [, other]) => one - other);
  const columns = groups.map((group, owner) => {
    const places = new Map(keys[owner]!.map((key, at) => [key, at]));
    return group.columns.map((column) => all.map(([key]) => column[places.get(key) ?? -1] ?? null));
  });
  return { x: all.map(([, one]) => one), columns };
}

/** A key for each point: a speed that a run dwells at keeps all of its points. */
function keysOf(x: number[]): string[] {
  const seen = new Map<number, number>();
  return x.map((one) => {
    const before = seen.get(one) ?? 0;
    seen.set(one, before + 1);
    return `${one} ${before}`;
  });
}
