// Why an identification failed, and what a person can do.
import { t } from "../messages/messages";

const REMEDIES: [RegExp, string][] = [
  [/NotEnoughData|too few|not enough/i, t("waitForARunThat")],
  [/OutOfTime|over time|too long/i, t("tryAgainWhenFewerAre")],
  [/memory/i, t("allowTheWorkersMoreMemory")],
  [/worker|killed|BrokenProcess|cluster/i, t("itIsTriedAgainBy")],
  [/released|deleted/i, t("theRunSSamplesAre")],
  [/document|unknown parameter|stiffness/i, t("checkTheMachineSDocument")],
];

export function jobRemedy(error: string | null): string {
  return REMEDIES.find(([form]) => form.test(error ?? ""))?.[1] ?? t("askForItAgainFrom");
}
