// An alert's states (ISA-18.2) in words, and what a person may do in each.
import type { Alert } from "../schemas/answers";

export type Deed = "acknowledge" | "reset" | "shelve" | "unshelve" | "comments";

const WORDS: Record<string, string> = {
  unacknowledged: "new",
  acknowledged: "acknowledged",
  returned: "cause gone, not acknowledged",
  latched_unacknowledged: "cause gone, to acknowledge and reset",
  latched_acknowledged: "cause gone, to reset",
  shelved: "shelved",
  suppressed_by_design: "suppressed by design",
  out_of_service: "out of service",
  normal: "closed",
};

export function stateInWords(state: string): string {
  return WORDS[state] ?? state;
}

/** Whether it was open at a moment. */
export function openAt(alert: Alert, at: string): boolean {
  return Date.parse(alert.opened_at) <= Date.parse(at) && (!alert.closed_at || Date.parse(alert.closed_at) > Date.parse(at));
}

/** Whether it waits for somebody to acknowledge it. */
export function calls(alert: Alert): boolean {
  return ["unacknowledged", "returned", "latched_unacknowledged"].includes(alert.state);
}

export const DEEDS: Record<Deed, { button: string; title: string; said: string }> = {
  acknowledge: { button: "Acknowledge", title: "Acknowledge", said: "was acknowledged" },
  reset: { button: "Reset", title: "Reset", said: "was reset" },
  shelve: { button: "Shelve …", title: "Shelve: it calls nobody until then", said: "is shelved" },
  unshelve: { button: "Unshelve", title: "End the shelving", said: "is no longer shelved" },
  comments: { button: "Comment …", title: "Comment", said: "has a comment" },
};

export function possible(alert: Alert): Deed[] {
  const deeds: Deed[] = [];
  const waits = ["unacknowledged", "returned", "latched_unacknowledged"].includes(alert.condition);
  if (waits) deeds.push("acknowledge");
  if (alert.condition === "latched_acknowledged") deeds.push("reset");
  if (alert.suppressions.includes("shelved")) deeds.push("unshelve");
  else if (!alert.closed_at) deeds.push("shelve");
  deeds.push("comments");
  return deeds;
}
