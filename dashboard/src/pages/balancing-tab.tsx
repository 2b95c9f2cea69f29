// Field balancing of a machine, for the person beside it.
import { FieldBalancingPanel } from "../panels/field-balancing-panel";
import type { Document } from "../schemas/machines";

export function BalancingTab({ machine }: { machine: Document }) {
  return <FieldBalancingPanel machine={machine} />;
}
