// Fields for a day, and for a minute, in the one form that all times of the page have, whatever the browser's language is.
import { useRef } from "preact/hooks";
import { isDay } from "../format/days";
import { isMinute } from "../format/times";
import { t } from "../messages/messages";

interface DayProps {
  label: string;
  value: string;
  onChoose: (day: string) => void;
}

/** A day, typed or chosen in the browser's calendar; what is no day is said to be none, and nothing is chosen. */
export function DayField({ label, value, onChoose }: DayProps) {
  const field = useRef<HTMLInputElement>(null);
  const take = (day: string) => {
    if (!field.current) return;
    field.current.value = day;
    field.current.setCustomValidity(day === "" || isDay(day) ? "" : t("dayForm"));
    if (field.current.reportValidity()) onChoose(day);
  };
  return (
    <label>
      {label}
      <span class="day">
        <input ref={field} type="text" inputMode="numeric" autoComplete="off" placeholder={t("dayPlaces")} title={t("dayForm")} size={11} value={value} onChange={(event) => take(event.currentTarget.value)} />
        <input type="date" tabIndex={-1} aria-hidden="true" value={isDay(value) ? value : ""} onChange={(event) => take(event.currentTarget.value)} />
      </span>
    </label>
  );
}

interface MinuteProps {
  label: string;
  name: string;
  required?: boolean;
  defaultValue?: string;
}

/** A minute of local time in a form. */
export function MinuteField({ label, name, required = false, defaultValue = "" }: MinuteProps) {
  const field = useRef<HTMLInputElement>(null);
  const check = () => field.current?.setCustomValidity(field.current.value === "" || isMinute(field.current.value) ? "" : t("minuteForm"));
  const choose = (picked: string) => {
    if (field.current) field.current.value = picked.replace("T", " ");
    check();
  };
  return (
    <label>
      {label}
      <span class="day">
        <input ref={field} type="text" name={name} required={required} autoComplete="off" placeholder={t("minutePlaces")} title={t("minuteForm")} defaultValue={defaultValue} onInput={check} />
        <input type="datetime-local" tabIndex={-1} aria-hidden="true" onChange={(event) => choose(event.currentTarget.value)} />
      </span>
    </label>
  );
}
