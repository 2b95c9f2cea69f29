// Columns over different speeds put on one axis, null where a column has no point.

type Column = (number | null)[];

export interface Group {
  x: number[];
  columns: Column[];
}

/** The ascending union of all x, and each group's columns over it. */
export function onCommonAxis(groups: Group[]): { x: number[]; columns: Column[][] } {
  const all = groups.flatMap((group, owner) => group.x.map((x, at) => ({ x, at, owner })));
  all.sort((a, b) => a.x - b.x);
  const columns = groups.map((group, owner) => group.columns.map((column) => all.map((one) => (one.owner === owner ? (column[one.at] ?? null) : null))));
  return { x: all.map((one) => one.x), columns };
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
