// What is drawn of a train besides where it lies: how thick the shaft is there, and probes that share a station [m].
import type { Drawing } from "../schemas/answers";

export interface Spot {
  element: string;
  at: number;
  /** Of the shaft there, or of the body itself. */
  radius: number;
}

export interface Layout {
  length: number;
  /** The largest that is drawn. */
  radius: number;
  sections: { at: number; length: number; radius: number }[];
  discs: (Spot & { width: number })[];
  bearings: Spot[];
  seals: Spot[];
  couplings: Spot[];
  probes: { channels: string[]; at: number; radius: number }[];
}

/** Probes this near to each other share a sign [m]. */
const SAME_STATION = 0.005;
/** A disc of which no size is known is so many times as thick as its shaft. */
const UNKNOWN_DISC = 3;

export function layout(drawing: Drawing): Layout {
  const sections = drawing.sections.map((one) => ({ at: one.begin, length: one.end - one.begin, radius: one.outer_diameter / 2 }));
  const shaft = (at: number) => Math.max(0.005, ...sections.filter((one) => at >= one.at - 1e-9 && at <= one.at + one.length + 1e-9).map((one) => one.radius));
  const spot = ({ element, at }: { element: string; at: number }): Spot => ({ element, at, radius: shaft(at) });
  const discs = drawing.discs.map((one) => ({ ...spot(one), radius: one.radius ?? UNKNOWN_DISC * shaft(one.at), width: one.width ?? 0 }));
  const probes: Layout["probes"] = [];
  for (const { channel, at } of drawing.probes) {
    const there = probes.find((other) => Math.abs(other.at - at) < SAME_STATION);
    if (there) there.channels.push(channel);
    else probes.push({ channels: [channel], at, radius: shaft(at) });
  }
  return {
    length: drawing.length,
    radius: Math.max(...sections.map((one) => one.radius), ...discs.map((one) => one.radius)),
    sections,
    discs,
    bearings: drawing.bearings.map(spot),
    seals: drawing.seals.map(spot),
    couplings: drawing.couplings.map(spot),
    probes,
  };
}
