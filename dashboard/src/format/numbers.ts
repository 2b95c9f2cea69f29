// Numbers with their units.
import { t } from "../messages/messages";

const PREFIXES: [number, string][] = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];
const SYMBOLS: Record<string, string> = { "kg m": "g·mm", "N/m": "N/m", "N s/m": "N·s/m", "N m/rad": "N·m/rad", "N m s/rad": "N·m·s/rad", "N m": "N·m", "Pa s": "Pa·s" };

/** Between thousands: narrow, and no line breaks there. */
const THOUSANDS = "\u202f";

export interface Scale {
  /** The value in SI times this is the number shown. */
  factor: number;
  unit: string;
}

/** The units that speeds and small lengths are shown in, with their factors from revolutions a minute and micrometres. */
export interface ShownUnits {
  speed: ShownUnit;
  length: ShownUnit;
}

export interface ShownUnit {
  label: string;
  factor: number;
}

const USUAL: ShownUnits = { speed: { label: t("rpm"), factor: 1 }, length: { label: "µm", factor: 1 } };

/** How numbers of some size in an SI unit are shown: 18 MN/m, 530 g·mm. */
export function scaleOf(largest: number, unit: string, { speed, length } = USUAL): Scale {
  if (unit === "kg m") return { factor: 1e6, unit: "g·mm" };
  if (unit === "" || unit === "-" || unit === "1") return { factor: 1, unit: "" };
  if (unit === "m") return { factor: 1e6 * length.factor, unit: length.label };
  if (unit === "rad") return { factor: 1e3, unit: "mrad" };
  if (unit === "kg") return { factor: 1, unit };
  if (unit === "rad/s") return { factor: (speed.factor * 30) / Math.PI, unit: speed.label };
  const size = Math.abs(largest);
  const [step, prefix] = PREFIXES.find(([at]) => size >= at) ?? [1, ""];
  return { factor: size > 0 ? 1 / step : 1, unit: (size > 0 ? prefix : "") + (SYMBOLS[unit] ?? unit) };
}

/** A value in the unit of a scale; null where there is none. */
export function scaled(value: number | null | undefined, scale: Scale): number | null {
  return value === null || value === undefined ? null : value * scale.factor;
}

/** Digits with the decimal mark of the language. */
export function decimal(digits: string): string {
  return digits.replace(".", t("decimalMark"));
}

/** A number with three significant digits, without an exponent where that is readable. */
export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  // What rounds up to the next power of ten has a digit more in front.
  const size = Math.abs(Number(value.toPrecision(digits)));
  if (size >= 1e7 || size < 1e-4) return decimal(value.toExponential(digits - 1).replace("-", "−"));
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return decimal(value.toFixed(Math.min(decimals, 8)).replace("-", "−"));
}

export function quantity(value: number | null | undefined, unit: string, units = USUAL): string {
  if (value === null || value === undefined) return "–";
  const scale = scaleOf(value, unit, units);
  return `${number(value * scale.factor)} ${scale.unit}`.trim();
}

export function percent(part: number, digits = 2): string {
  const shown = number(100 * part, digits);
  return `${part > 0 ? "+" : ""}${shown} %`;
}

export function rpm(value: number | null | undefined): string {
  return value === null || value === undefined ? "–" : `${Math.round(value).toLocaleString("en-GB").replaceAll(",", THOUSANDS)} ${t("rpm")}`;
}
