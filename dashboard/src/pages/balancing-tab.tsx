// Field balancing of a machine, for the person beside it.
import { BalancingGate } from "../panels/balancing-gate";
import { FieldBalancingPanel } from "../panels/field-balancing-panel";
import type { Document } from "../schemas/machines";

export function BalancingTab({ machine }: { machine: Document }) {
  return (
    <BalancingGate machine={machine.id}>
      {/* It keeps its place whatever comes: an alert that is raised meanwhile ends no form that somebody is filling in. */}
      {(hidden, warning) => <FieldBalancingPanel key="balancing" machine={machine} hidden={hidden} warning={warning} />}
    </BalancingGate>
  );
}
