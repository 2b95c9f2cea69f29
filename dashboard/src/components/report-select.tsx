// How often somebody gets the reports of machines by mail.
import type { ReportInterval } from "../schemas/subscriptions";

const CHOICES: [ReportInterval | "", string][] = [
  ["", "never"],
  ["weekly", "weekly"],
  ["monthly", "monthly"],
];

interface Props {
  value: ReportInterval | null;
  onChoose?: (chosen: ReportInterval | null) => void;
}

export function ReportSelect({ value, onChoose }: Props) {
  return (
    <select name="reports" value={value ?? ""} onChange={(event) => onChoose?.((event.currentTarget.value || null) as ReportInterval | null)}>
      {CHOICES.map(([name, words]) => (
        <option key={name} value={name}>
          {words}
        </option>
      ))}
    </select>
  );
}
