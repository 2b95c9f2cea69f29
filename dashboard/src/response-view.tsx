import type { Document } from "./answers";
export function ResponseView({ machine }: { machine: Document }) { return <p>{machine.id}</p>; }
