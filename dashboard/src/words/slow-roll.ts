// Which slow-roll vectors were subtracted from measured phasors.
import { t } from "../messages/messages";

/** leftOut: channels without a vector in that version. */
export function slowRollText(version: number | null, leftOut: string[] = []): string {
  if (version === null) return t("asMeasuredNoSlowRoll");
  return t("slowRollSubtractedVersion", { version, but: leftOut.length > 0 ? t("butNotAt", { channels: leftOut.join(", ") }) : "" });
}
