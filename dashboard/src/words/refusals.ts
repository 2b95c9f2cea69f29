// Refused input in a person's words: what was refused, how much, and what is probably wrong.
import type { QuarantineEntry } from "../schemas/operation";

export interface Refusal {
  reason: string;
  /** How many values or messages; at least so many where older ones are no longer kept. */
  count: number;
  words: string;
  /** What the service says of the newest one. */
  detail: string;
  newest: string;
}

const MEANINGS: Record<string, string> = {
  too_large: "messages are larger than what is taken; send fewer samples in each",
  bad_frame: "messages are cut off or damaged on their way",
  undecodable: "messages cannot be read; the format is not one that the service knows",
  future_schema: "the sender is newer than this service; update the service",
  key_mismatch: "messages name another machine than their key; check the sender's configuration",
  unknown_machine: "they name a machine that does not exist; create it, or correct the name",
  unknown_channel: "they name a channel that the document does not have; correct either",
  unknown_condition: "they name an operating condition that the document does not have; correct either",
  wrong_unit: "they name a unit that is not known; correct the sender's configuration",
  wrong_shape: "not every channel has a value; check the sender",
  not_finite: "values are no numbers; check the sensor and its wiring",
  speed_out_of_range: "the speed is beyond what the machine can reach; check the unit of the speed, and the pulses per turn",
  speed_out_of_order: "the speed jumps; check the keyphasor",
  amplitude_out_of_range: "the vibration is larger than a probe can see; check the unit of the amplitude",
  gap_out_of_range: "gaps are larger than a probe can see; check their unit and sign",
  gap_undescribed: "the document does not say which way the probes' gaps grow; add gap_grows",
  overall_out_of_range: "overall levels are larger than a probe can see; check their unit",
  retained: "the broker kept the messages, and their age is unknown; publish samples without the retain flag",
  sequence_out_of_range: "the counter of the source is beyond its range; restart the source",
  time_out_of_range: "times are wrong; set the source's clock",
  time_out_of_order: "times go back; check the source's clock",
  unexpected_error: "the service failed at them; its log says why",
  damaged_block: "the disk has damaged what was stored; restore a backup",
};
const OTHERS = /and (\d+) more in this batch/;
const TIME_NS = /time (-?\d+) ns/;
/** The year 2000 [s], and so in units that are taken for nanoseconds by mistake. */
const YEAR_2000_S = 946_684_800;
const UNITS: [number, string][] = [
  [1, "seconds"],
  [1e3, "milliseconds"],
  [1e6, "microseconds"],
];

/** One for each reason, the most frequent first. */
export function refusals(entries: QuarantineEntry[]): Refusal[] {
  const found = new Map<string, Refusal>();
  for (const { reason, detail, received_at: at } of entries) {
    const count = 1 + Number(OTHERS.exec(detail)?.[1] ?? 0);
    const known = found.get(reason);
    if (known) known.count += count;
    else found.set(reason, { reason, count, words: meaning(reason, detail), detail, newest: at });
  }
  return [...found.values()].sort((one, other) => other.count - one.count);
}

/** `800 values refused: times look like milliseconds`. */
export function refusalText({ count, words }: Refusal): string {
  return `${count} refused: ${words}`;
}

function meaning(reason: string, detail: string): string {
  const time = reason === "time_out_of_range" ? Number(TIME_NS.exec(detail)?.[1]) : NaN;
  // A time of the present in a coarser unit is far too small a number of nanoseconds.
  const unit = UNITS.find(([factor]) => time >= YEAR_2000_S * factor && time < 10 * YEAR_2000_S * factor)?.[1];
  if (unit) return `times look like ${unit}; they must be nanoseconds since 1970`;
  return MEANINGS[reason] ?? reason.replaceAll("_", " ");
}
