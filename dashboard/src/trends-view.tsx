import type { Document } from "./answers";
export function TrendsView({ machine }: { machine: Document }) { return <p>{machine.id}</p>; }
