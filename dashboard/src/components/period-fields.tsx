// Fields to choose a period by its first and last day.
import { replaceQuery } from "../browser/router";
import { t } from "../messages/messages";
import { DayField } from "./time-field";

export function PeriodFields({ first, last }: { first: string; last: string }) {
  return (
    <>
      <DayField label={t("from")} value={first} onChoose={(day) => replaceQuery({ from: day || null })} />
      <DayField label={t("to")} value={last} onChoose={(day) => replaceQuery({ to: day || null })} />
    </>
  );
}
