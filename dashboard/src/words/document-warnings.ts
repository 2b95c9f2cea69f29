// Warnings of a machine document as text: elements by their names, not by their places in the document.
import { elementName } from "../format/names";
import type { Document } from "../schemas/machines";

const KINDS = { bearings: "bearing", couplings: "coupling", seals: "seal", pedestals: "pedestal" } as const;
const WARNING = /^(bearings|couplings|seals|pedestals)\[(\d+)\]\.([^:]+): (.*)$/s;

/** What a warning concerns, null where it names no element, and what it says. */
export function documentWarning(line: string, machine: Document): { where: string | null; words: string } {
  const [, list, place, field, words] = WARNING.exec(line) ?? [];
  const kind = list as keyof typeof KINDS;
  const element = list ? machine[kind]?.[Number(place)] : undefined;
  if (!element || words === undefined) return { where: null, words: line };
  return { where: `${elementName(`${KINDS[kind]}.${element.id}`)}, ${field}`, words };
}
