// How often somebody gets the reports of machines by mail.
import { t } from "../messages/messages";
import type { ReportInterval } from "../schemas/subscriptions";

const CHOICES: [ReportInterval | "", string][] = [
  ["", t("never")],
  ["weekly", t("weekly")],
  ["monthly", t("monthly")],
];

interface Props {
  value: ReportInterval | null;
  onChoose: (chosen: ReportInterval | null) => void;
}

export function ReportSelect({ value, onChoose }: Props) {
  return (
    <select name="reports" value={value ?? ""} onChange={(event) => onChoose((event.currentTarget.value || null) as ReportInterval | null)}>
      {CHOICES.map(([name, words]) => (
        <option key={name} value={name}>
          {words}
        </option>
      ))}
    </select>
  );
}
