// How a 1× stands to the machine's limits, and these as text.
import { number } from "../format/numbers";
import { t, term } from "../messages/messages";
import type { SeverityZones, VibrationLimits } from "../schemas/vibration";

/** Boundaries between the zones, by the name of each. */
export function zoneBoundaries(zones: SeverityZones | null): [string, number][] {
  return zones ? [["A/B", zones.a_b_um_pp], ["B/C", zones.b_c_um_pp], ["C/D", zones.c_d_um_pp]] : [];
}

/** The zones and their source; empty without any. */
export function zonesText(zones: SeverityZones | null, unit: { label: string; factor: number }): string {
  if (!zones) return "";
  const limits = zoneBoundaries(zones).map(([name, value]) => `${name} ${number(value * unit.factor)}`);
  return t("severityZones", { source: zones.source, boundaries: limits.join(", "), unit: unit.label });
}

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
