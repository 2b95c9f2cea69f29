// The settings of a machine: suppressed alerts, and limits.
import { LimitsPanel } from "../panels/limits-panel";
import { SuppressionsPanel } from "../panels/suppressions-panel";
import type { Document } from "../schemas/machines";

export function SettingsTab({ machine }: { machine: Document }) {
  return (
    <>
      <SuppressionsPanel machine={machine} />
      <LimitsPanel machine={machine} />
    </>
  );
}
