// Numbers with units, times in the reader's zone.
import type { Document, Sense } from "../schemas/answers";

const PREFIXES: [number, string][] = [
  [1e9, "G"],
  [1e6, "M"],
  [1e3, "k"],
  [1, ""],
  [1e-3, "m"],
  [1e-6, "µ"],
  [1e-9, "n"],
];
const SAID: Record<string, string> = { "kg m": "g·mm", "N/m": "N/m", "N s/m": "N·s/m", "N m/rad": "N·m/rad", "N m s/rad": "N·m·s/rad", "N m": "N·m" };

export interface Scale {
  /** The value in SI times this is the number shown. */
  factor: number;
  unit: string;
}

/** How numbers of some size in an SI unit are shown: 18 MN/m, 530 g·mm. */
export function scaleOf(largest: number, unit: string): Scale {
  if (unit === "kg m") return { factor: 1e6, unit: "g·mm" };
  if (unit === "" || unit === "-" || unit === "1") return { factor: 1, unit: "" };
  if (unit === "m") return { factor: 1e6, unit: "µm" };
  if (unit === "kg") return { factor: 1, unit };
  if (unit === "rad/s") return { factor: 30 / Math.PI, unit: "rpm" };
  const size = Math.abs(largest);
  const [step, prefix] = PREFIXES.find(([at]) => size >= at) ?? [1, ""];
  return { factor: size > 0 ? 1 / step : 1, unit: (size > 0 ? prefix : "") + (SAID[unit] ?? unit) };
}

/** A number with three significant digits, without an exponent where that is readable. */
export function number(value: number | null | undefined, digits = 3): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  // What rounds up to the next power of ten has a digit more in front.
  const size = Math.abs(Number(value.toPrecision(digits)));
  if (size >= 1e7 || size < 1e-4) return value.toExponential(digits - 1).replace("-", "−");
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 8)).replace("-", "−");
}

export function quantity(value: number | null | undefined, unit: string, digits = 3): string {
  if (value === null || value === undefined) return "–";
  const scale = scaleOf(value, unit);
  return `${number(value * scale.factor, digits)} ${scale.unit}`.trim();
}

export function percent(part: number, digits = 2): string {
  const shown = number(100 * part, digits);
  return `${part > 0 ? "+" : ""}${shown} %`;
}

export function rpm(value: number | null | undefined): string {
  return value === null || value === undefined ? "–" : `${Math.round(value).toLocaleString("en-GB").replaceAll(",", " ")} rpm`;
}

const DAY = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", year: "numeric" });
const MINUTE = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit", hourCycle: "h23" });
const SECOND = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

/** Local time, as short as its distance allows. */
export function when(iso: string): string {
  const at = new Date(iso);
  return Math.abs(Date.now() - at.getTime()) > 300 * 86_400_000 ? DAY.format(at) : MINUTE.format(at);
}

export function clock(ms: number): string {
  return SECOND.format(ms);
}

export function utc(iso: string): string {
  return `${new Date(iso).toISOString().slice(0, 19).replace("T", " ")} UTC`;
}

export function ago(iso: string): string {
  const seconds = (Date.now() - new Date(iso).getTime()) / 1000;
  if (seconds < 90) return `${Math.max(0, Math.round(seconds))} s ago`;
  if (seconds < 5400) return `${Math.round(seconds / 60)} min ago`;
  if (seconds < 129_600) return `${Math.round(seconds / 3600)} h ago`;
  return `${Math.round(seconds / 86_400)} days ago`;
}

/** `coupling C1` from `coupling.C1`. */
export function elementName(element: string): string {
  return element.replace(".", " ");
}

/** `kxx` from `bearing.B1.kxx`. */
export function termName(parameter: string): string {
  return parameter.split(".").slice(2).join(".") || parameter;
}

/** How angles of unbalances count; what lags, as all measured phases do, counts against the rotation. */
export function angleSense(rotation: Sense = "positive"): string {
  return `from the mark, +x towards +y, ${rotation === "positive" ? "with" : "against"} rotation`;
}

export function isUnbalance(parameter: string): boolean {
  return termName(parameter) === "unbalance";
}

/** Cross-coupled terms may be near zero: their changes are told in per cent of the direct terms beside them, or not at all. */
export function isCrossCoupled(parameter: string): boolean {
  return /(xy|yx)(@|$)/.test(parameter);
}

/** All elements of a machine that alerts may be of: `coupling.C1`. */
export function elementsOfDocument(machine: Document): string[] {
  const named = (kind: string, all: { id: string }[]) => all.map((one) => `${kind}.${one.id}`);
  return [...named("coupling", machine.couplings), ...named("bearing", machine.bearings), ...named("disc", machine.discs), ...named("probe", machine.probes)];
}

/** As the estimator has it, in estimator/whirl.py. */
const PLANAR = 0.05;

/** Of a whirl between -1, circular against the rotation, and 1, circular with it. */
export function whirlInWords(whirl: number): string {
  if (Math.abs(whirl) < PLANAR) return "planar";
  return whirl > 0 ? "forward" : "backward";
}
