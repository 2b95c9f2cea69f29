// Names of elements and parameters as people read them.

/** `coupling C1` from `coupling.C1`. */
export function elementName(element: string): string {
  return element.replace(".", " ");
}

/** `kxx` from `bearing.B1.kxx`. */
export function termName(parameter: string): string {
  return parameter.split(".").slice(2).join(".") || parameter;
}

const COMPONENTS: Record<string, string> = { real: "real part", imaginary: "imaginary part" };
/** Quantities derived from an identification, by their names in the API. */
const DERIVED: [RegExp, (...parts: string[]) => string][] = [
  [/^critical_speed\.(\d+)$/, (number) => `critical speed ${number}`],
  [/^damping_ratio\.(\d+)$/, (number) => `damping ratio at critical speed ${number}`],
  [/^splitting\.(\d+)-(\d+)$/, (one, other) => `critical speeds ${one} and ${other}: distance over their mean`],
  [/^probe\.([^.]+)\.amplification_factor\.(\d+)$/, (probe, number) => `amplification factor at ${probe}, critical speed ${number}`],
  [/^probe\.([^.]+)\.second_over_first$/, (probe) => `2× over 1× at ${probe}`],
  [/^coupling\.([^.]+)\.misalignment_(force|moment)$/, (coupling, what) => `misalignment ${what} in coupling ${coupling}`],
];

/** A parameter or derived quantity as people read it: `coupling C1 kxx`, `critical speed 2`. */
export function parameterName(parameter: string): string {
  for (const [form, named] of DERIVED) {
    const found = form.exec(parameter);
    if (found) return named(...found.slice(1));
  }
  const [kind, id, ...term] = parameter.split(".");
  if (term.length === 0) return words(parameter);
  return `${kind} ${id} ${term.map((one) => COMPONENTS[one] ?? one).join(", ").replaceAll("_", " ")}`;
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
