// An alert's states (ISA-18.2) in words, and the actions that each allows.
import { findingLabel, findingTitle } from "../findings/findings";
import { elementName } from "../format/names";
import { t, term } from "../messages/messages";
import type { Alert } from "../schemas/alerts";

export type AlertAction = "acknowledge" | "instruct" | "reset" | "shelve" | "unshelve" | "comments";

const STATES: Record<string, string> = {
  unacknowledged: t("unacknowledged"),
  acknowledged: t("acknowledged"),
  returned: t("returnedToNormalUnacknowledged"),
  latched_unacknowledged: t("latchedUnacknowledged"),
  latched_acknowledged: t("latchedAcknowledgedToBeReset"),
  shelved: t("shelved"),
  suppressed_by_design: t("suppressedByDesign"),
  out_of_service: t("outOfService"),
  normal: t("stateClosed"),
};
const UNACKNOWLEDGED = ["unacknowledged", "returned", "latched_unacknowledged"];

export function alertStateLabel(state: string): string {
  return STATES[state] ?? state;
}

export function wasOpenAt(alert: Alert, at: string): boolean {
  return Date.parse(alert.opened_at) <= Date.parse(at) && (!alert.closed_at || Date.parse(alert.closed_at) > Date.parse(at));
}

/** Whether it waits for somebody to acknowledge it: not while it is shelved or suppressed. */
export function isUnacknowledged(alert: Alert): boolean {
  return UNACKNOWLEDGED.includes(alert.state);
}

export const ALERT_ACTIONS: Record<AlertAction, { button: string; title: string }> = {
  acknowledge: { button: t("acknowledge"), title: t("acknowledge") },
  instruct: { button: t("instructTheCrewDots"), title: t("instructTheCrew") },
  reset: { button: t("reset"), title: t("reset") },
  shelve: { button: t("shelveDots"), title: t("shelveNoNotificationsUntilThen") },
  unshelve: { button: t("unshelve"), title: t("unshelve") },
  comments: { button: t("commentDots"), title: t("comment") },
};

export function availableActions(alert: Alert): AlertAction[] {
  const actions: AlertAction[] = [];
  if (UNACKNOWLEDGED.includes(alert.condition)) actions.push("acknowledge");
  if (alert.condition === "latched_acknowledged") actions.push("reset");
  if (alert.suppressions.includes("shelved")) actions.push("unshelve");
  else if (!alert.closed_at) actions.push("shelve");
  if (!alert.closed_at) actions.push("instruct");
  actions.push("comments");
  return actions;
}

/** What an alert is about, as a heading: `Misalignment of coupling C1`. */
export function alertTitle({ rule, element }: Pick<Alert, "rule" | "element">): string {
  return findingTitle(rule, element);
}

/** The API's limit for a comment. */
const LONGEST_COMMENT = 2000;

/** Text that an instruction to the crew begins with: what was found, to be completed by who gives it. */
export function instructionDraft(alert: Alert): string {
  const { actions = [], check = [] } = alert.advice ?? {};
  const lines = [t("forTheCrew", { title: alertTitle(alert), message: alert.message })];
  for (const { opportunity, text } of actions) lines.push(`- ${term(opportunity)}: ${text}`);
  if (check.length > 0) lines.push(t("toCheck", { what: check.join("; ") }));
  return lines.join("\n").slice(0, LONGEST_COMMENT);
}

/** The findings and elements that a suppression holds for. */
export function suppressionScope({ rule, element }: { rule: string | null; element: string | null }): string {
  if (!rule && !element) return t("theWholeMachine");
  return [rule && findingLabel(rule), element && elementName(element)].filter(Boolean).join(", ");
}
