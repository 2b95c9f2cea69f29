// The dimensions of a train's drawing: radii of shafts and discs, and probes that share a station [m].
import type { Drawing } from "../schemas/machines";

export interface Position {
  element: string;
  at: number;
  /** Radius of the shaft at that place, or of the body itself. */
  radius: number;
}

export interface TrainLayout {
  length: number;
  /** The largest of all bodies. */
  radius: number;
  sections: { at: number; length: number; radius: number }[];
  discs: (Position & { width: number })[];
  bearings: Position[];
  seals: Position[];
  pedestals: Position[];
  couplings: Position[];
  probes: { channels: string[]; at: number; radius: number }[];
}

/** Probes this near to each other are drawn as one [m]. */
const SAME_STATION = 0.005;
/** Radius of a disc of unknown size, in radii of its shaft. */
const UNKNOWN_DISC = 3;

export function trainLayout(drawing: Drawing): TrainLayout {
  const sections = drawing.sections.map((one) => ({ at: one.begin, length: one.end - one.begin, radius: one.outer_diameter / 2 }));
  const shaft = (at: number) => Math.max(0.005, ...sections.filter((one) => at >= one.at - 1e-9 && at <= one.at + one.length + 1e-9).map((one) => one.radius));
  const position = ({ element, at }: { element: string; at: number }): Position => ({ element, at, radius: shaft(at) });
  const discs = drawing.discs.map((one) => ({ ...position(one), radius: one.radius ?? UNKNOWN_DISC * shaft(one.at), width: one.width ?? 0 }));
  const probes: TrainLayout["probes"] = [];
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
    bearings: drawing.bearings.map(position),
    seals: drawing.seals.map(position),
    pedestals: drawing.pedestals.map(position),
    couplings: drawing.couplings.map(position),
    probes,
  };
}
