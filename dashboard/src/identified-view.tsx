import type { Document } from "./answers";
export function IdentifiedView({ machine }: { machine: Document }) { return <p>{machine.id}</p>; }
