// Where everything lies along the train, from its document [m].
import type { Document } from "./answers";

export interface Spot {
  id: string;
  z: number;
  /** Of the shaft there, or of the body itself. */
  radius: number;
}

export interface Layout {
  length: number;
  /** The largest that is drawn. */
  radius: number;
  sections: { z: number; length: number; radius: number }[];
  discs: (Spot & { width: number })[];
  bearings: Spot[];
  seals: Spot[];
  couplings: Spot[];
  probes: { ids: string[]; z: number; radius: number }[];
  /** Where each shaft begins, in the order of the train. */
  begins: Map<string, number>;
}

/** Steel, for the size of a disc of which only mass and inertia are known [kg/m³]. */
const DENSITY = 7850;
/** Probes this near to each other share a sign [m]. */
const SAME_STATION = 0.005;

function shaftsInOrder(machine: Document): string[] {
  const next = new Map(machine.couplings.map((one) => [one.driver, one.driven]));
  const driven = new Set(next.values());
  const order: string[] = [];
  for (const first of machine.shafts.map((one) => one.id).filter((id) => !driven.has(id))) {
    for (let id: string | undefined = first; id !== undefined && !order.includes(id); id = next.get(id)) order.push(id);
  }
  return order;
}

export function layout(machine: Document): Layout {
  const begins = new Map<string, number>();
  const sections: Layout["sections"] = [];
  let z = 0;
  for (const id of shaftsInOrder(machine)) {
    begins.set(id, z);
    for (const section of machine.shafts.find((one) => one.id === id)!.sections) {
      sections.push({ z, length: section.length, radius: section.outer_diameter / 2 });
      z += section.length;
    }
  }
  const place = (shaft: string, station: number) => (begins.get(shaft) ?? 0) + station;
  const shaftRadius = (at: number) =>
    Math.max(...sections.filter((one) => at >= one.z - 1e-9 && at <= one.z + one.length + 1e-9).map((one) => one.radius), 0.005);
  const spot = (one: { id: string; shaft: string; station: number }): Spot => {
    const at = place(one.shaft, one.station);
    return { id: one.id, z: at, radius: shaftRadius(at) };
  };
  const discs = machine.discs.map((one) => {
    // A plain steel disc of this mass and polar inertia: I = m r²/2, m = ρ π r² b.
    const at = place(one.shaft, one.station);
    const radius = one.polar_inertia > 0 ? Math.sqrt((2 * one.polar_inertia) / one.mass) : 3 * shaftRadius(at);
    return { id: one.id, z: at, radius, width: one.mass / (DENSITY * Math.PI * radius * radius) };
  });
  const couplings = machine.couplings.map((one) => {
    const at = begins.get(one.driven) ?? 0;
    return { id: one.id, z: at, radius: shaftRadius(at) };
  });
  const probes: Layout["probes"] = [];
  for (const one of machine.probes) {
    const at = spot(one);
    const there = probes.find((other) => Math.abs(other.z - at.z) < SAME_STATION);
    if (there) there.ids.push(one.id);
    else probes.push({ ids: [one.id], z: at.z, radius: at.radius });
  }
  return {
    length: z,
    radius: Math.max(...sections.map((one) => one.radius), ...discs.map((one) => one.radius)),
    sections,
    discs,
    bearings: machine.bearings.map(spot),
    seals: machine.seals.map(spot),
    couplings,
    probes,
    begins,
  };
}
