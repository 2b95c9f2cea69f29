// Phases without jumps of a whole turn.
import type { Column } from "../schemas/columns";

/** Phases [°] without jumps of a whole turn; nulls are skipped. */
export function unwrapPhase(phase: Column): Column {
  let last: number | null = null;
  return phase.map((one) => {
    if (one === null) return null;
    last = last === null ? one : one + 360 * Math.round((last - one) / 360);
    return last;
  });
}

/** Phases [°] shifted by whole turns to be nearest to a curve over ascending speeds. */
export function nearestTurns(x: number[], phase: Column, curveX: number[], curve: Column): Column {
  return phase.map((one, at) => {
    const there = one === null ? null : interpolate(x[at]!, curveX, curve);
    return one === null || there === null ? one : one + 360 * Math.round((there - one) / 360);
  });
}

function interpolate(x: number, curveX: number[], curve: Column): number | null {
  const next = curveX.findIndex((one) => one >= x);
  const high = next < 0 ? curveX.length - 1 : Math.max(1, next);
  const [x0, x1, y0, y1] = [curveX[high - 1], curveX[high], curve[high - 1], curve[high]];
  if (x0 === undefined || x1 === undefined || y0 === null || y0 === undefined || y1 === null || y1 === undefined) return null;
  return y0 + ((y1 - y0) * Math.min(1, Math.max(0, (x - x0) / (x1 - x0 || 1))));
}
