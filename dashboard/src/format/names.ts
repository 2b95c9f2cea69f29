// Names of elements and parameters as people read them.

/** `coupling C1` from `coupling.C1`. */
export function elementName(element: string): string {
  return element.replace(".", " ");
}

/** `kxx` from `bearing.B1.kxx`. */
export function termName(parameter: string): string {
  return parameter.split(".").slice(2).join(".") || parameter;
}

/** An identifier of the API as words: `run out` from `run_out`. */
export function words(identifier: string): string {
  return identifier.replaceAll("_", " ");
}

export function isUnbalance(parameter: string): boolean {
  return termName(parameter) === "unbalance";
}

/** Cross-coupled terms may be near zero: their changes are given in per cent of the direct terms beside them, or not at all. */
export function isCrossCoupled(parameter: string): boolean {
  return /(xy|yx)(@|$)/.test(parameter);
}
