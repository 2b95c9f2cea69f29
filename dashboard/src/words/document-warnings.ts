// Warnings of a machine document as text: elements by their names, not by their places in the document.
import { elementName } from "../format/names";
import type { ShownUnit } from "../format/numbers";
import { stored } from "../messages/messages";
import type { Document } from "../schemas/machines";

const KINDS = { bearings: "bearing", couplings: "coupling", seals: "seal", pedestals: "pedestal" } as const;
const WARNING = /^(?:(bearings|couplings|seals|pedestals)\[(\d+)\]\.)?([^:]+): (.*)$/s;

/** What a warning concerns, an element by its name, and what it says; null where it names nothing. length: unit of its lengths. */
export function documentWarning(line: string, machine: Document, length: ShownUnit): { where: string | null; words: string } {
  const [, list, place, field, words] = WARNING.exec(line) ?? [];
  const kind = list as keyof typeof KINDS;
  const element = list ? machine[kind]?.[Number(place)] : undefined;
  if (words === undefined) return { where: null, words: line };
  return { where: element ? `${elementName(`${KINDS[kind]}.${element.id}`)}, ${field}` : line.slice(0, -words.length - 2), words: stored(words, length) };
}
