// How each element is marked on the drawing of the train: by its deviation from the baseline and its alerts.
import { words } from "../format/names";
import { t, term } from "../messages/messages";
import type { Alert } from "../schemas/alerts";
import type { Deviations } from "../schemas/trends";
import { isUnacknowledged } from "../words/alert-states";
import { CHANGED, deviationText, largestDeviation } from "../words/deviations";

/** The words accompany the colour, which never stands alone. */
export interface Mark {
  level: "normal" | "changed" | "alert" | "danger" | "unknown";
  words: string;
}

export const UNKNOWN: Mark = { level: "unknown", words: t("unknownNothingToCompareWith") };
export const MARK_SIGNS: Record<Mark["level"], string> = { normal: "", changed: "●", alert: "▲", danger: "◆", unknown: "" };
const RANK: Record<Mark["level"], number> = { unknown: 0, normal: 1, changed: 2, alert: 3, danger: 4 };

/** Marks by element, from the deviations of an identification and the alerts that are open beside it. */
export function elementMarks(open: Alert[], deviations: Deviations | undefined): Map<string, Mark> {
  const marks = new Map<string, Mark>();
  const add = (element: string, level: Mark["level"], text: string) => {
    const before = marks.get(element);
    const all = [before?.words, text].filter(Boolean).join("\n");
    marks.set(element, { level: before && RANK[before.level] > RANK[level] ? before.level : level, words: all });
  };
  for (const { element, probability } of deviations?.elements ?? []) {
    // The levels alert and danger come from alerts only: these know the cause, a deviation does not.
    const most = largestDeviation(deviations!, element);
    if (probability >= CHANGED || !most) add(element, "normal", t("atBaseline"));
    else add(element, "changed", `${deviationText(most)}${most.reaches ? t("reachesLimitFor", { level: term(most.reaches) }) : ""}`);
  }
  for (const alert of open) {
    const level = alert.severity === "danger" ? "danger" : "alert";
    // An alert that was closed later was open then, in a state that is not known.
    const state = alert.closed_at || isUnacknowledged(alert) ? "" : ` (${words(alert.state)})`;
    add(alert.element, level, `${alert.message}${state}`);
  }
  return marks;
}

/** The element with the worst mark; undefined where all are normal. */
export function worstElement(marks: Map<string, Mark>): string | undefined {
  for (const level of ["danger", "alert", "changed"]) {
    for (const [element, mark] of marks) if (mark.level === level) return element;
  }
  return undefined;
}
