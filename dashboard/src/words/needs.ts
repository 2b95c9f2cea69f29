// What a machine of the fleet needs from a person today, the most urgent first.
import { t } from "../messages/messages";
import type { FleetMachine } from "../schemas/machines";

export interface Need {
  words: string;
  /** Higher comes first. */
  urgency: number;
}

/** Everything that waits for somebody; empty for a machine that can be left alone. */
export function needs(one: FleetMachine): Need[] {
  const found: Need[] = [];
  const add = (urgency: number, words: string) => found.push({ urgency, words });
  const waits = one.unacknowledged > 0;
  const worst = (one.open_alerts.danger ?? 0) > 0 ? "danger" : (one.open_alerts.alert ?? 0) > 0 ? "alert" : null;
  if (worst && waits) add(worst === "danger" ? 6 : 5, t("judgeAlerts", { what: one.unacknowledged === 1 ? t("anAlert") : t("countedAlerts", { count: one.unacknowledged }) }));
  if (one.vibration_beyond_danger) add(6, t("actOnVibration", { channel: one.vibration_beyond_danger.channel }));
  if (worst === "danger" && !waits) add(4, t("actOnADanger"));
  if (one.happened.refused > 0) add(3, t("mendItsDataSomeWere"));
  if (one.last_identification && !one.last_identification.accepted) add(2, t("lookAtARunThat"));
  if (one.outside_speed_range) add(2, t("checkItsSpeeds"));
  if (one.failed_job) add(2, t("seeToAFailedJob"));
  if (worst === "alert" && !waits) add(1, t("actOnAnAlert"));
  return found.sort((a, b) => b.urgency - a.urgency);
}

export function needOrder(one: FleetMachine): number {
  return needs(one)[0]?.urgency ?? 0;
}
