// How far each element is from its baseline: its colour and words on the drawing of the train.
import type { Alert } from "./answers";
import { calls } from "./alert-words";
import type { Mark } from "./train";

const RANK: Record<Mark["level"], number> = { unknown: 0, normal: 1, changed: 2, alert: 3, danger: 4 };

export function marksOf(alerts: Alert[]): Map<string, Mark> {
  const marks = new Map<string, Mark>();
  const put = (element: string, mark: Mark) => {
    const there = marks.get(element);
    if (!there || RANK[mark.level] > RANK[there.level]) marks.set(element, mark);
  };
  for (const alert of alerts) {
    if (alert.closed_at) continue;
    const level = alert.severity === "danger" ? "danger" : "alert";
    put(alert.element, { level, words: `${alert.message}${calls(alert) ? "" : ` (${alert.state.replaceAll("_", " ")})`}` });
  }
  return marks;
}
