// Refused input in a person's words: what was refused, how much, and what is probably wrong.
import { t, term } from "../messages/messages";
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
  too_large: t("messagesAreLargerThanWhat"),
  bad_frame: t("messagesAreCutOffOr"),
  undecodable: t("messagesCannotBeReadThe"),
  future_schema: t("theSenderIsNewerThan"),
  key_mismatch: t("messagesNameAnotherMachineThan"),
  unknown_machine: t("theyNameAMachineThat"),
  unknown_channel: t("theyNameAChannelThat"),
  unknown_condition: t("theyNameAnOperatingCondition"),
  wrong_unit: t("theyNameAUnitThat"),
  wrong_shape: t("notEveryChannelHasA"),
  not_finite: t("valuesAreNoNumbersCheck"),
  speed_out_of_range: t("theSpeedIsBeyondWhat"),
  speed_out_of_order: t("theSpeedJumpsCheckThe"),
  amplitude_out_of_range: t("theVibrationIsLargerThan"),
  gap_out_of_range: t("gapsAreLargerThan"),
  gap_undescribed: t("theDocumentDoesNotSayWhichWay"),
  overall_out_of_range: t("overallLevelsAreLargerThan"),
  retained: t("theBrokerKeptTheMessages"),
  sequence_out_of_range: t("theCounterOfTheSource"),
  time_out_of_range: t("timesAreWrongSetThe"),
  time_out_of_order: t("timesGoBackCheckThe"),
  unexpected_error: t("theServiceFailedAtThem"),
  damaged_block: t("theDiskHasDamagedWhat"),
};
const OTHERS = /and (\d+) more in this batch/;
const TIME_NS = /time (-?\d+) ns/;
/** The year 2000 [s], and so in units that are taken for nanoseconds by mistake. */
const YEAR_2000_S = 946_684_800;
const UNITS: [number, string][] = [
  [1, t("seconds")],
  [1e3, t("milliseconds")],
  [1e6, t("microseconds")],
];

/** One text for each reason, the most frequent first. */
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
  return t("refusedBecause", { count, meaning: words });
}

function meaning(reason: string, detail: string): string {
  const time = reason === "time_out_of_range" ? Number(TIME_NS.exec(detail)?.[1]) : NaN;
  // A time of the present in a coarser unit is far too small a number of nanoseconds.
  const unit = UNITS.find(([factor]) => time >= YEAR_2000_S * factor && time < 10 * YEAR_2000_S * factor)?.[1];
  if (unit) return t("timesLookLike", { unit });
  return MEANINGS[reason] ?? term(reason);
}
