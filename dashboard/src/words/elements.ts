// The elements of a machine and of an identification.
import { ALERTING_LISTS } from "../declarations/elements";
import type { Estimate } from "../schemas/identifications";
import type { Document } from "../schemas/machines";

/** All elements of a machine that alerts may concern: `coupling.C1`. */
export function elementsOfMachine(machine: Document): string[] {
  return ALERTING_LISTS.flatMap(([kind, list]) => (machine[list] ?? []).map((one: { id: string }) => `${kind}.${one.id}`));
}

/** The elements that parameters were estimated of, in their order. */
export function elementsOfEstimates(estimates: Estimate[]): string[] {
  return [...new Set(estimates.map((one) => one.element))];
}
