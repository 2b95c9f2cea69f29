// An alert's severity as a sign with its own shape and colour, and a word.
import { term } from "../messages/messages";

/** The worst first. */
const SIGNS: Record<string, string> = { danger: "◆", alert: "▲", info: "●" };

/** The worst of several severities; undefined without any. */
export function worstSeverity(severities: string[]): string | undefined {
  return Object.keys(SIGNS).find((one) => severities.includes(one));
}

export function Severity(props: { severity: string; acknowledged?: boolean; word?: boolean }) {
  const { severity, acknowledged = false, word = true } = props;
  return (
    <span class={`severity ${severity} ${acknowledged ? "acknowledged" : ""}`} title={term(severity)}>
      <span aria-hidden="true">{SIGNS[severity] ?? "●"}</span>
      <span class={word ? undefined : "hidden"}> {term(severity)}</span>
    </span>
  );
}
