// Fields to choose a period by its first and last day.
import { replaceQuery } from "../browser/router";
import { t } from "../messages/messages";

export function PeriodFields({ first, last }: { first: string; last: string }) {
  return (
    <>
      <label>
        {t("from")}
        <input type="date" value={first} max={last || undefined} onChange={(event) => replaceQuery({ from: event.currentTarget.value || null })} />
      </label>
      <label>
        {t("to")}
        <input type="date" value={last} min={first || undefined} onChange={(event) => replaceQuery({ to: event.currentTarget.value || null })} />
      </label>
    </>
  );
}
