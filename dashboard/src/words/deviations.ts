// How far an element is from its baseline, in words.
import { isCrossCoupled, isUnbalance, parameterName, quantityName } from "../format/names";
import { number, percent, quantity, type ShownUnit } from "../format/numbers";
import { t } from "../messages/messages";
import type { Deviations, ElementSize, ParameterDeviation } from "../schemas/trends";

/** Elements less probable than this in the baseline state have changed. */
export const CHANGED = 1e-3;

/** Probability below which a change is certain. */
const CERTAIN = 1e-6;
/** Probability below which a deviation is more than chance makes now and then. */
const PERHAPS = 0.05;

/** Whether an element has changed, by the probability of its deviation without any change. */
export function changeText(probability: number): string {
  if (probability < CERTAIN) return t("yesCertainly");
  if (probability < CHANGED) return t("yes");
  return probability < PERHAPS ? t("perhaps") : t("no");
}

/** A probability as `one of 400`. */
export function chanceText(probability: number): string {
  if (probability < 1e-9) return t("lessThanOneOfA");
  return t("oneOf", { count: number(1 / probability, 2) });
}

/** A parameter's deviation in words: kxx +54 % (10.5 σ). */
export function deviationText(one: ParameterDeviation): string {
  const term = quantityName(one.parameter);
  const sigma = `${number(one.sigma, 2)} σ`;
  if (one.added !== null) {
    // A vector's change has a direction instead of a sign: balancing reduces an unbalance by adding one.
    const part = t("ofTheBaselines", { per_cent: number(one.per_cent, 2) });
    if (!isUnbalance(one.parameter)) return t("changedAsVector", { term, part, sigma });
    return t("addedAt2", { term, added: quantity(one.added, "kg m"), angle: Math.round(one.added_angle_deg ?? 0) % 360, part, sigma });
  }
  return `${term} ${percent(one.per_cent / 100)}${isCrossCoupled(one.parameter) ? t("ofDirectTerms") : ""} (${sigma})`;
}

const SIZE_UNITS: Record<string, string> = { "g mm": "g·mm", "N m": "N·m" };
/** Angles are told in milliradians everywhere, from microradians. */
const MILLIRADIANS: ShownUnit = { label: "mrad", factor: 1e-3 };

/** What an element has changed by as a whole, as its alert says it; null where no diagnosis says that it has. length: unit of lengths. */
export function togetherText(deviations: Deviations, element: string, length: ShownUnit): string | null {
  const all = deviations.elements.find((one) => one.element === element)?.together ?? [];
  // What is told from what to what, such as a load that follows from the coefficients, is left to the alert.
  const together = all.some((one) => one.before === null) ? all.filter((one) => one.before === null) : all;
  return together.length > 0 ? together.map((one) => sizeText(one, length)).join("; ") : null;
}

function sizeText({ name, unit, value, lower, upper, runs }: ElementSize, length: ShownUnit): string {
  const { factor, label } = unit === "um" ? length : unit === "urad" ? MILLIRADIANS : { factor: 1, label: SIZE_UNITS[unit] ?? unit };
  const signed = (one: number) => `${one > 0 ? "+" : ""}${number(one * factor, 2)}`;
  const interval = t("sizeWithInterval", { value: signed(value), unit: label, lower: signed(lower), upper: signed(upper) });
  const size = name.endsWith(".coefficients") ? t("allCoefficientsTogether", { size: interval }) : `${parameterName(name)} ${interval}`;
  return runs !== null && runs > 1 ? t("meanOfNewestRuns", { size, runs }) : size;
}

export function largestDeviation(deviations: Deviations, element: string): ParameterDeviation | undefined {
  const own = deviations.parameters.filter((one) => one.element === element);
  return own.sort((a, b) => Math.abs(b.sigma) - Math.abs(a.sigma))[0];
}
