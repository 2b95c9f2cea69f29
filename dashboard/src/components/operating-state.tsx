// A machine's operating state as a sign and a word.

const STATES: Record<string, [string, string]> = {
  stopped: ["■", "stopped"],
  "slow roll": ["◔", "slow roll"],
  slow_roll: ["◔", "slow roll"],
  "run-up": ["▲", "run-up"],
  "at speed": ["●", "at speed"],
  at_speed: ["●", "at speed"],
  "run-down": ["▼", "run-down"],
  trip: ["⏷", "trip"],
  unknown: ["○", "unknown"],
};

export function OperatingState({ state }: { state: string }) {
  const [sign, word] = STATES[state] ?? ["○", state];
  return (
    <span class={`mode ${state === "trip" ? "trip" : ""}`}>
      <span aria-hidden="true">{sign}</span> {word}
    </span>
  );
}
