// Choose the units of vibration and speed.
import { useStore } from "../browser/store";
import { chooseUnits, UNIT_CHOICES, unitChoice } from "../browser/units";
import { t } from "../messages/messages";

export function UnitSelect() {
  const now = useStore(unitChoice);
  return (
    <select class="units" aria-label={t("unitsOfVibrationAndSpeed")} value={now} onChange={(event) => chooseUnits(event.currentTarget.value)}>
      {UNIT_CHOICES.map(([name, { amplitude, speed }]) => (
        <option key={name} value={name}>
          {`${amplitude.label}, ${speed.label}`}
        </option>
      ))}
    </select>
  );
}
