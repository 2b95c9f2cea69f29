// How far each element is from its baseline: its colour and words on the drawing of the train.
import type { Alert, Deviations, ParameterDeviation } from "../schemas/answers";
import { calls } from "../words/alert-states";
import { isCrossCoupled, isUnbalance, number, percent, quantity, termName } from "../words/format";
import type { Mark } from "./train-drawing";

/** An element whose parameters would move together as far as this by chance less often than this has changed. */
export const CHANGED = 1e-3;
const RANK: Record<Mark["level"], number> = { unknown: 0, normal: 1, changed: 2, alert: 3, danger: 4 };

/** The largest of an element's deviations in words: kxx +54 % (10.5 σ). */
export function inWords(one: ParameterDeviation): string {
  const term = termName(one.parameter);
  const sigma = `${number(one.sigma, 2)} σ`;
  if (one.added !== null) {
    // A vector's change has a direction in the place of a sign: what is balanced gets less by what is added.
    const part = `${number(one.per_cent, 2)} % of the baseline's`;
    if (!isUnbalance(one.parameter)) return `${term}: changed by ${part}, as a vector (${sigma})`;
    return `${term}: ${quantity(one.added, "kg m")} added at ${Math.round(one.added_angle_deg ?? 0) % 360}° (${part}, ${sigma})`;
  }
  return `${term} ${percent(one.per_cent / 100)}${isCrossCoupled(one.parameter) ? " of the direct terms" : ""} (${sigma})`;
}

export function largest(deviations: Deviations, element: string): ParameterDeviation | undefined {
  const own = deviations.parameters.filter((one) => one.element === element);
  return own.sort((a, b) => Math.abs(b.sigma) - Math.abs(a.sigma))[0];
}

/** What an identification and the alerts that are open beside it say of each element. */
export function marksOf(open: Alert[], deviations: Deviations | undefined): Map<string, Mark> {
  const marks = new Map<string, Mark>();
  const put = (element: string, level: Mark["level"], words: string) => {
    const there = marks.get(element);
    const said = [there?.words, words].filter(Boolean).join("\n");
    marks.set(element, { level: there && RANK[there.level] > RANK[level] ? there.level : level, words: said });
  };
  for (const { element, probability } of deviations?.elements ?? []) {
    // Alert and danger are said by alerts only: they know the cause, a deviation does not.
    const most = largest(deviations!, element);
    if (probability >= CHANGED || !most) put(element, "normal", "as at the baseline");
    else put(element, "changed", `${inWords(most)}${most.reaches ? `, reaches the limit for ${most.reaches}` : ""}`);
  }
  for (const alert of open) {
    const level = alert.severity === "danger" ? "danger" : "alert";
    // One that was closed later was open then: in which state is not known.
    const said = alert.closed_at || calls(alert) ? "" : ` (${alert.state.replaceAll("_", " ")})`;
    put(alert.element, level, `${alert.message}${said}`);
  }
  return marks;
}
