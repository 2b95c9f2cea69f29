// How a 1× stands to the machine's limits, and these as text.
import { number } from "../format/numbers";
import { t, term } from "../messages/messages";
import type { VibrationLimits } from "../schemas/vibration";

export type VibrationLevel = "danger" | "alert" | "normal" | "unknown";

export const LEVEL_SIGNS: Record<VibrationLevel, string> = { danger: "◆", alert: "▲", normal: "", unknown: "" };

/** unknown: without a value, or without limits. */
export function vibrationLevel(amplitude: number | undefined, { alert_um_pp: alert, danger_um_pp: danger }: VibrationLimits): VibrationLevel {
  if (amplitude === undefined || (alert === null && danger === null)) return "unknown";
  if (danger !== null && amplitude >= danger) return "danger";
  return alert !== null && amplitude >= alert ? "alert" : "normal";
}

/** unit: that of the text, with its factor from µm peak-to-peak. */
export function limitsText(limits: VibrationLimits, unit: { label: string; factor: number }): string {
  const named: [string, number | null][] = [
    [term("alert"), limits.alert_um_pp],
    [term("danger"), limits.danger_um_pp],
    [t("balancedUpTo"), limits.balanced_um_pp],
  ];
  const given = named.flatMap(([name, value]) => (value === null ? [] : [`${name} ${number(value * unit.factor)} ${unit.label}`]));
  if (given.length === 0) return t("documentNamesNoLimits");
  return t("limitsOfFirstOrder", { limits: given.join(", ") });
}
