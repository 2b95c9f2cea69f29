// The shaft's motion: orbits of a run, and mode shapes of the newest identified model.
import { ModeShapesPanel } from "../identification/mode-shapes-panel";
import type { Document } from "../schemas/machines";
import { OrbitsPanel } from "../vibration/orbits-panel";

export function ShapesTab({ machine }: { machine: Document }) {
  return (
    <>
      <OrbitsPanel machine={machine} />
      <ModeShapesPanel machine={machine} />
    </>
  );
}
