// The probes that see most of an element: those nearest to it on either side.
import { elementKind } from "../format/names";
import type { Drawing } from "../schemas/machines";

/** Probes this near to each other are at one station [m]. */
const SAME_STATION = 0.005;

/** Channels of the nearest station, of a coupling on either side of it; none for an element without a place. */
export function nearestChannels(drawing: Drawing, element: string): string[] {
  const at = placeOf(drawing, element);
  if (at === undefined) return [];
  const sides = elementKind(element) === "coupling"
    ? [drawing.probes.filter((one) => one.at <= at), drawing.probes.filter((one) => one.at > at)]
    : [drawing.probes];
  return sides.flatMap((probes) => {
    const nearest = Math.min(...probes.map((one) => Math.abs(one.at - at)));
    return probes.filter((one) => Math.abs(one.at - at) <= nearest + SAME_STATION).map((one) => one.channel);
  });
}

/** The place of an element along the train [m]; of a misplaced or unknown one undefined. */
function placeOf(drawing: Drawing, element: string): number | undefined {
  const { discs, bearings, seals, pedestals, couplings, probes } = drawing;
  const probe = probes.find((one) => `probe.${one.channel}` === element);
  return probe?.at ?? [...discs, ...bearings, ...seals, ...pedestals, ...couplings].find((one) => one.element === element)?.at;
}
