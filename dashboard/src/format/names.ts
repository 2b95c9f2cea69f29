// Names of elements and parameters as people read them.
import { TERMS } from "../declarations/terms";
import { t, term } from "../messages/messages";

/** `coupling C1` from `coupling.C1`. */
export function elementName(element: string): string {
  const [kind, ...id] = element.split(".");
  return [term(kind!), ...id].join(" ");
}

/** `bearing` from `bearing.B1`. */
export function elementKind(element: string): string {
  return element.split(".")[0]!;
}

/** `B1` from `bearing.B1`; empty for the machine as a whole. */
export function elementId(element: string): string {
  return element.split(".").slice(1).join(".");
}

/** `bearing.B1` from `bearing.B1.kxx`. */
export function elementOf(parameter: string): string {
  return parameter.split(".").slice(0, 2).join(".");
}

/** `kxx` from `bearing.B1.kxx`. */
export function termName(parameter: string): string {
  return parameter.split(".").slice(2).join(".") || parameter;
}

/** A parameter without its element as people read it: `Unwucht`; the API's name where there is no word for it. */
export function quantityName(parameter: string): string {
  const name = termName(parameter);
  const worded = term(name);
  return worded === name.replaceAll("_", " ") ? name : worded;
}

const COMPONENTS: Record<string, string> = { real: t("realPart"), imaginary: t("imaginaryPart") };
/** Quantities derived from an identification, by their names in the API. */
const DERIVED: [RegExp, (...parts: string[]) => string][] = [
  [/^critical_speed\.(\d+)$/, (number) => t("criticalSpeed", { number })],
  [/^damping_ratio\.(\d+)$/, (number) => t("dampingRatioAtCriticalSpeed", { number })],
  [/^splitting\.(\d+)-(\d+)$/, (one, other) => t("criticalSpeedsAndDistanceOver", { one, other })],
  [/^probe\.([^.]+)\.amplification_factor\.(\d+)$/, (probe, number) => t("amplificationFactorAtCriticalSpeed", { probe, number })],
  [/^probe\.([^.]+)\.second_over_first$/, (probe) => t("n2Over1At", { probe })],
  [/^coupling\.([^.]+)\.misalignment_(force|moment)$/, (coupling, what) => t("misalignmentLoad", { what: term(what!), coupling })],
];

/** A parameter or derived quantity as people read it: `coupling C1 kxx`, `critical speed 2`. */
export function parameterName(parameter: string): string {
  for (const [form, named] of DERIVED) {
    const found = form.exec(parameter);
    if (found) return named(...found.slice(1));
  }
  const [kind, id, ...quantity] = parameter.split(".");
  if (quantity.length === 0) return words(parameter);
  return `${term(kind!)} ${id} ${quantity.map((one) => COMPONENTS[one] ?? term(one)).join(", ")}`;
}

/** An identifier of the API as words: `run out` from `run_out`. */
export const words = term;

export function isUnbalance(parameter: string): boolean {
  return termName(parameter) === "unbalance";
}

/** Cross-coupled terms may be near zero: their changes are given in per cent of the direct terms beside them, or not at all. */
export function isCrossCoupled(parameter: string): boolean {
  const [name] = termName(parameter).split(/[@.]/);
  return TERMS[name!]?.direct === false;
}
