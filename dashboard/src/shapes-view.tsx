import type { Document } from "./answers";
export function ShapesView({ machine }: { machine: Document }) { return <p>{machine.id}</p>; }
