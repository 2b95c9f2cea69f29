// How the estimates of an identification hang together: a matrix as a picture, and the pairs that are hardly told apart.
import { useState } from "preact/hooks";
import type { Correlation } from "../schemas/answers";
import { arrow, within } from "../plots/arrow-keys";
import { number } from "../words/format";
import { Empty, Panel, Shown } from "../components/parts";
import { useResource } from "../data/resource";

const CELL = 9;
/** So many pairs are written out. */
const PAIRS = 12;

export function CorrelationPanel({ identification }: { identification: string }) {
  const answer = useResource<Correlation>(`/identifications/${identification}/correlation`);
  return (
    <Panel title="Which estimates hang together">
      <Shown answer={answer} lines={20}>
        {(found) => (
          <div class="columns">
            <Matrix key={identification} found={found} />
            <Pairs found={found} />
          </div>
        )}
      </Shown>
    </Panel>
  );
}

function Matrix({ found }: { found: Correlation }) {
  const [at, setAt] = useState<[number, number] | null>(null);
  const count = found.coordinates.length;
  const size = count * CELL;
  const point = (event: PointerEvent) => {
    const box = (event.currentTarget as SVGElement).getBoundingClientRect();
    const index = (part: number) => within(Math.floor(part * count), count);
    setAt([index((event.clientY - box.top) / box.height), index((event.clientX - box.left) / box.width)]);
  };
  const keyed = (event: KeyboardEvent) => {
    const step = arrow(event);
    if (!step && event.key !== "Escape") return;
    event.preventDefault();
    setAt(step && (at ? [within(at[0] + step[1], count), within(at[1] + step[0], count)] : [0, 0]));
  };
  return (
    <figure class="correlation">
      <svg
        viewBox={`0 0 ${size} ${size}`}
        role="group"
        tabindex={0}
        aria-label={`Correlation of ${count} estimates; the strongest pairs are listed beside. Arrow keys move the read-out.`}
        onKeyDown={keyed}
        onPointerDown={point}
        onPointerMove={point}
        onPointerLeave={(event) => event.pointerType !== "touch" && setAt(null)}
      >
        {found.correlation.flatMap((row, i) =>
          row.map((value, j) => {
            // Area says how much, as shape says the sign: a square is positive, a diamond negative.
            const half = (CELL / 2) * Math.sqrt(Math.abs(value));
            if (half < 0.6) return null;
            const x = j * CELL + CELL / 2;
            const y = i * CELL + CELL / 2;
            return value > 0 ? (
              <rect x={x - half} y={y - half} width={2 * half} height={2 * half} class="positive" />
            ) : (
              <path d={`M${x} ${y - half}L${x + half} ${y}L${x} ${y + half}L${x - half} ${y}Z`} class="negative" />
            );
          }),
        )}
        {at && <rect class="chosen" x={at[1] * CELL} y={at[0] * CELL} width={CELL} height={CELL} />}
      </svg>
      <figcaption class="muted" aria-live="polite">
        {at ? `${found.coordinates[at[0]]} and ${found.coordinates[at[1]]}: ${number(found.correlation[at[0]]![at[1]], 2)}` : "■ together, ◆ against each other; the larger, the more"}
      </figcaption>
    </figure>
  );
}

function Pairs({ found }: { found: Correlation }) {
  if (found.strongest.length === 0) return <Empty>No two estimates are correlated beyond ±0.9: the data tell all of them apart.</Empty>;
  return (
    <div>
      <p>The data hardly tell these apart; what is said of one may be the other's:</p>
      <ul class="reasons">
        {found.strongest.slice(0, PAIRS).map((one) => (
          <li key={`${one.one} ${one.other}`}>
            {one.one} and {one.other}: {number(one.correlation, 3)}
          </li>
        ))}
      </ul>
      {found.strongest.length > PAIRS && <p class="muted">The strongest {PAIRS} of {found.strongest.length} are shown.</p>}
    </div>
  );
}
