// Colours and dashes of curves, signs of markers.
import type { Marker } from "./plot-props";

/** Colours of curves; beyond them they begin again. */
export const COLOURS = 6;
export const MARKER_SIGNS: Record<Marker["kind"], string> = { alert: "▲", danger: "◆", maintenance: "✚", note: "●", speed: "" };

const DASHES: number[][] = [[], [7, 3], [2, 3], [9, 3, 2, 3], [12, 4], [4, 2]];

/** A curve's dashes. Beyond the last colour they move on by one, so that no two curves look alike. */
export function dash(style: number): number[] {
  return DASHES[(style + Math.floor(style / COLOURS)) % DASHES.length]!;
}

const BAND_ALPHA = 0.2;

/** A curve's colour as that of its band. */
export function transparent(colour: string): string {
  return /^#[0-9a-f]{6}$/i.test(colour) ? `${colour}${Math.round(255 * BAND_ALPHA).toString(16)}` : colour;
}
