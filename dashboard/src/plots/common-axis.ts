// Columns over different speeds put on one axis, null where a column has no point.

type Column = (number | null)[];

export interface Group {
  x: number[];
  columns: Column[];
}

/** The ascending union of all x, and each group's columns over it: where groups have the same x they share it. */
export function onCommonAxis(groups: Group[]): { x: number[]; columns: Column[][] } {
  const keys = groups.map(({ x }) => numbered(x));
  const rows = new Map(groups.flatMap(({ x }, owner) => x.map((one, at) => [keys[owner]![at]!, one])));
  const all = [...rows].sort(([, one], [, other]) => one - other);
  const columns = groups.map((group, owner) => {
    const places = new Map(keys[owner]!.map((key, at) => [key, at]));
    return group.columns.map((column) => all.map(([key]) => column[places.get(key) ?? -1] ?? null));
  });
  return { x: all.map(([, one]) => one), columns };
}

/** A speed that a run dwells at keeps all of its points: each has a key of its own. */
function numbered(x: number[]): string[] {
  const seen = new Map<number, number>();
  return x.map((one) => {
    const before = seen.get(one) ?? 0;
    seen.set(one, before + 1);
    return `${one} ${before}`;
  });
}

/** Phases [°] without their jumps over a whole turn; what is null is passed over. */
export function unwrapped(phase: Column): Column {
  let last: number | null = null;
  return phase.map((one) => {
    if (one === null) return null;
    last = last === null ? one : one + 360 * Math.round((last - one) / 360);
    return last;
  });
}

/** Phases [°] shifted by whole turns to be nearest to a curve over ascending speeds. */
export function beside(x: number[], phase: Column, curveX: number[], curve: Column): Column {
  return phase.map((one, at) => {
    const there = one === null ? null : interpolated(x[at]!, curveX, curve);
    return one === null || there === null ? one : one + 360 * Math.round((there - one) / 360);
  });
}

function interpolated(x: number, curveX: number[], curve: Column): number | null {
  const next = curveX.findIndex((one) => one >= x);
  const high = next < 0 ? curveX.length - 1 : Math.max(1, next);
  const [x0, x1, y0, y1] = [curveX[high - 1], curveX[high], curve[high - 1], curve[high]];
  if (x0 === undefined || x1 === undefined || y0 === null || y0 === undefined || y1 === null || y1 === undefined) return null;
  return y0 + ((y1 - y0) * Math.min(1, Math.max(0, (x - x0) / (x1 - x0 || 1))));
}
