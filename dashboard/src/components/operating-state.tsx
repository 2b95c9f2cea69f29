// A machine's operating state as a sign and a word.
import { term } from "../messages/messages";

const SIGNS: Record<string, string> = {
  stopped: "■",
  "slow roll": "◔",
  slow_roll: "◔",
  "run-up": "▲",
  "at speed": "●",
  at_speed: "●",
  "run-down": "▼",
  trip: "⏷",
  unknown: "○",
};

export function OperatingState({ state }: { state: string }) {
  return (
    <span class={`mode ${state === "trip" ? "trip" : ""}`}>
      <span aria-hidden="true">{SIGNS[state] ?? "○"}</span> {term(state)}
    </span>
  );
}
