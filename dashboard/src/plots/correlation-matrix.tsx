// A correlation matrix as a picture, read out by pointer and keys.
import type { DataColumn } from "../browser/download";
import { useState } from "preact/hooks";
import { parameterName } from "../format/names";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import type { Correlation } from "../schemas/identifications";
import { arrowStep, clampIndex } from "./arrow-keys";
import { SaveDrawing } from "./save-buttons";

const CELL = 9;
/** Smaller signs would not be seen. */
const SMALLEST = 0.6;

export function CorrelationMatrix({ found }: { found: Correlation }) {
  const [at, setAt] = useState<[number, number] | null>(null);
  const count = found.coordinates.length;
  const size = count * CELL;
  const onPointer = (event: PointerEvent) => {
    const box = (event.currentTarget as SVGElement).getBoundingClientRect();
    const index = (part: number) => clampIndex(Math.floor(part * count), count);
    setAt([index((event.clientY - box.top) / box.height), index((event.clientX - box.left) / box.width)]);
  };
  const onKey = (event: KeyboardEvent) => {
    const step = arrowStep(event);
    if (!step && event.key !== "Escape") return;
    event.preventDefault();
    setAt(step && (at ? [clampIndex(at[0] + step[1], count), clampIndex(at[1] + step[0], count)] : [0, 0]));
  };
  return (
    <figure class="correlation">
      <SaveDrawing label={t("correlationOfTheEstimates")} columns={() => columnsOf(found)} />
      <svg
        viewBox={`0 0 ${size} ${size}`}
        role="group"
        tabindex={0}
        aria-label={t("correlationOf", { count })}
        onKeyDown={onKey}
        onPointerDown={onPointer}
        onPointerMove={onPointer}
        onPointerLeave={(event) => event.pointerType !== "touch" && setAt(null)}
      >
        {found.correlation.flatMap((row, i) => row.map((value, j) => <CorrelationCell value={value} x={(j + 0.5) * CELL} y={(i + 0.5) * CELL} />))}
        {at && <rect class="chosen" x={at[1] * CELL} y={at[0] * CELL} width={CELL} height={CELL} />}
      </svg>
      <figcaption class="muted" aria-live="polite">
        {at ? t("pairCorrelation", { one: parameterName(found.coordinates[at[0]]!), other: parameterName(found.coordinates[at[1]]!), correlation: number(found.correlation[at[0]]![at[1]], 2) }) : t("positiveNegativeTheAreaIs")}
      </figcaption>
    </figure>
  );
}

function columnsOf({ coordinates, correlation }: Correlation): DataColumn[] {
  return [{ name: t("csvEstimate"), values: coordinates }, ...coordinates.map((name, column) => ({ name, values: correlation.map((row) => row[column]!) }))];
}

/** A square for a positive correlation, a diamond for a negative one. */
function CorrelationCell({ value, x, y }: { value: number; x: number; y: number }) {
  const half = (CELL / 2) * Math.sqrt(Math.abs(value));
  if (half < SMALLEST) return null;
  if (value > 0) return <rect x={x - half} y={y - half} width={2 * half} height={2 * half} class="positive" />;
  return <path d={`M${x} ${y - half}L${x + half} ${y}L${x} ${y + half}L${x - half} ${y}Z`} class="negative" />;
}
