// A speed in the unit that is chosen.
import { useUnits } from "../browser/units";
import { number, rpm as inRpm } from "../format/numbers";

export function Speed({ rpm }: { rpm: number | null | undefined }) {
  const text = useSpeedText();
  return <>{text(rpm)}</>;
}

/** Writes speeds in the unit that is chosen. */
export function useSpeedText(): (rpm: number | null | undefined) => string {
  const { speed } = useUnits();
  if (speed.factor === 1) return inRpm;
  return (rpm) => (rpm === null || rpm === undefined ? "–" : `${number(rpm * speed.factor, 4)} ${speed.label}`);
}
