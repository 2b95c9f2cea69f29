// What a machine of the fleet needs from a person today, the most urgent first.
import { DEFAULT_UNITS, type Units } from "../browser/units";
import { number } from "../format/numbers";
import { when } from "../format/times";
import { t } from "../messages/messages";
import type { FleetMachine } from "../schemas/machines";

export interface Need {
  words: string;
  /** Higher comes first. */
  urgency: number;
}

/** Everything that waits for somebody; empty for a machine that can be left alone. The units change words only. */
export function needs(one: FleetMachine, units: Units = DEFAULT_UNITS): Need[] {
  const found: Need[] = [];
  const add = (urgency: number, words: string) => found.push({ urgency, words });
  const waits = one.unacknowledged > 0;
  const worst = (one.open_alerts.danger ?? 0) > 0 ? "danger" : (one.open_alerts.alert ?? 0) > 0 ? "alert" : null;
  if (worst && waits) add(worst === "danger" ? 6 : 5, t("judgeAlerts", { what: one.unacknowledged === 1 ? t("anAlert") : t("countedAlerts", { count: one.unacknowledged }) }));
  if (one.vibration_beyond_danger) add(6, dangerWords(one.vibration_beyond_danger, units));
  if (worst === "danger" && !waits) add(4, t("actOnADanger"));
  if (one.happened.refused > 0) add(3, t("mendItsDataSomeWere"));
  if (one.last_identification && !one.last_identification.accepted) add(2, t("lookAtARunThat"));
  if (one.outside_speed_range) add(2, t("checkItsSpeeds"));
  if (one.failed_job) add(2, t("seeToAFailedJob"));
  if (worst === "alert" && !waits) add(1, t("actOnAnAlert"));
  return found.sort((a, b) => b.urgency - a.urgency);
}

function dangerWords(beyond: NonNullable<FleetMachine["vibration_beyond_danger"]>, { amplitude, speed }: Units): string {
  return t("actOnVibration", {
    channel: beyond.channel,
    amplitude: number(beyond.amplitude_um_pp * amplitude.factor),
    limit: number(beyond.danger_um_pp * amplitude.factor),
    unit: amplitude.label,
    speed: `${number(beyond.speed_rpm * speed.factor, 4)} ${speed.label}`,
    when: when(beyond.last_at),
  });
}

export function needOrder(one: FleetMachine): number {
  return needs(one)[0]?.urgency ?? 0;
}
