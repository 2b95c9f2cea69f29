// A speed in the unit that is chosen.
import { useUnits } from "../browser/units";
import { number, rpm as inRpm } from "../format/numbers";

export function Speed({ rpm }: { rpm: number | null | undefined }) {
  const { speed } = useUnits();
  if (rpm === null || rpm === undefined) return <>–</>;
  return <>{speed.factor === 1 ? inRpm(rpm) : `${number(rpm * speed.factor, 4)} ${speed.label}`}</>;
}
