// What people have set for a machine: whose alerts call nobody, and from where on something is an alert.
import type { Document } from "../schemas/answers";
import { LimitsPanel } from "../panels/limits-panel";
import { SuppressionsPanel } from "../panels/suppressions-panel";

export function SettingsView({ machine }: { machine: Document }) {
  return (
    <>
      <SuppressionsPanel machine={machine} />
      <LimitsPanel machine={machine} />
    </>
  );
}
