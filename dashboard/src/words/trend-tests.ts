// What the trend tests say of a parameter, in sentences: of which component, where it is one of a vector.
import type { Drift, TrendTest } from "../schemas/answers";
import { isCrossCoupled, number, percent, when } from "./format";

/** A drift that chance would make less often than this is told. */
const TOLD = 0.01;
const PARTS: Record<string, string> = { real: "real part", imaginary: "imaginary part" };

/** One sentence for each finding; none where nothing was found. */
export function findings(parameter: string, tests: TrendTest[]): string[] {
  return tests.flatMap((test) => {
    const part = test.name.startsWith(`${parameter}.`) ? test.name.slice(parameter.length + 1) : "";
    const of = part ? `${PARTS[part] ?? part}: ` : "";
    return [...steps(test), ...creeps(test), ...drifts(test, part ? " of the baseline's magnitude" : isCrossCoupled(parameter) ? " of the direct terms" : "")].map((one) => of + one);
  });
}

function steps(test: TrendTest): string[] {
  const since = (began: string | null) => (began ? `, likeliest since ${when(began)}` : "");
  return [
    ...(test.step_up.passed ? [`a step up${since(test.step_up.began)}`] : []),
    ...(test.step_down?.passed ? [`a step down${since(test.step_down.began)}`] : []),
  ];
}

function creeps({ creep }: TrendTest): string[] {
  return creep.passed ? [`the mean of its newest runs lies ${creep.value > 0 ? "above" : "below"} the baseline`] : [];
}

/** of: a component is measured in the length that the vector has at the baseline, a cross-coupled term in the direct ones. */
function drifts({ drift }: TrendTest, of: string): string[] {
  if (!drift || drift.probability >= TOLD) return [];
  return [`${percent(drift.per_week / 100)}${of} a week (${number(drift.lower, 2)} … ${number(drift.upper, 2)})${ahead(drift)}`];
}

function ahead(drift: Drift): string {
  const next = [drift.alert, drift.danger].find((one) => one?.expected !== null && one?.expected !== undefined && one.expected > 0);
  return next ? `, reaches ${number(next.per_cent, 2)} % in ${number(next.expected, 2)} weeks` : "";
}
