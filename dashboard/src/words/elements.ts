// The elements of a machine and of an identification.
import type { Estimate } from "../schemas/identifications";
import type { Document } from "../schemas/machines";

/** All elements of a machine that alerts may concern: `coupling.C1`. */
export function elementsOfMachine(machine: Document): string[] {
  const named = (kind: string, all: { id: string }[]) => all.map((one) => `${kind}.${one.id}`);
  return [...named("coupling", machine.couplings), ...named("bearing", machine.bearings), ...named("disc", machine.discs), ...named("probe", machine.probes)];
}

/** The elements that parameters were estimated of, in their order. */
export function elementsOfEstimates(estimates: Estimate[]): string[] {
  return [...new Set(estimates.map((one) => one.element))];
}
