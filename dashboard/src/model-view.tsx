import type { Document } from "./answers";
export function ModelView({ machine }: { machine: Document }) { return <p>{machine.id}</p>; }
