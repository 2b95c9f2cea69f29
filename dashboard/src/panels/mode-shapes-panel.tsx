// Mode shapes of the identified model along the train, in the phase in which they are largest.
import type { Displacement, Document, Drawing, Modes, ModeShape } from "../schemas/answers";
import { number, rpm, whirlInWords } from "../words/format";
import { Empty, Panel, Shown } from "../components/parts";
import { useResource } from "../data/resource";
import { Awaited, Behind, NotIdentified, useNewest } from "../data/newest-identification";

const WIDTH = 420;
const HEIGHT = 130;
const MARGIN = 12;
const MOST = 8;
/** Modes damped more than this have no shape that anybody sees. */
const HEAVY = 0.9;

function modesOf(id: number): string {
  return `/identifications/${id}/model/modes`;
}

export function ModeShapes({ machine }: { machine: Document }) {
  const { newest, none, failure, listed } = useNewest(machine.id, (id) => [modesOf(id)]);
  const answer = useResource<Modes>(newest ? modesOf(newest.id) : null);
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`).data;
  if (none) return <NotIdentified />;
  if (!newest) return <Awaited title="Mode shapes" failure={failure} />;
  return (
    <Panel title={`Mode shapes of identification ${newest.id}`} aside={<p class="muted">solid: x, dashed: y, shaded: the orbits' semi-major axis</p>}>
      <Behind failure={failure} listed={listed} />
      <Shown answer={answer} lines={20}>
        {(found) => (
          <>
            <p class="muted">At {rpm(found.speed)}. The largest semi-major axis is 1; couplings are dotted lines, bearings triangles.</p>
            {found.modes.length === 0 && <Empty>No mode up to twice the highest speed.</Empty>}
            <LeftOut modes={found.modes} />
            <div class="modes shapes">
              {drawing &&
                found.modes
                  .filter(isFelt)
                  .slice(0, MOST)
                  .map((mode) => <Shape key={mode.frequency_hz} mode={mode} drawing={drawing} />)}
            </div>
          </>
        )}
      </Shown>
    </Panel>
  );
}

function isFelt(mode: ModeShape): boolean {
  return mode.damping_ratio < HEAVY;
}

/** Which modes have no picture. */
function LeftOut({ modes }: { modes: ModeShape[] }) {
  const felt = modes.filter(isFelt).length;
  const heavy = modes.length - felt;
  return (
    <>
      {felt > MOST && <p class="muted cut">The lowest {MOST} of {felt} modes are shown.</p>}
      {heavy > 0 && <p class="muted cut">{heavy} that {heavy === 1 ? "is" : "are"} damped by {100 * HEAVY} % or more {heavy === 1 ? "is" : "are"} left out.</p>}
    </>
  );
}

function Shape({ mode, drawing }: { mode: ModeShape; drawing: Drawing }) {
  const at = (z: number) => MARGIN + (z / drawing.length) * (WIDTH - 2 * MARGIN);
  const up = (value: number) => HEIGHT / 2 - value * (HEIGHT / 2 - 16);
  const turn = -phaseOfLargest(mode);
  const line = (where: number[], values: number[]) => `M${where.map((z, index) => `${at(z).toFixed(1)} ${up(values[index]!).toFixed(1)}`).join("L")}`;
  const now = (one: Displacement) => one.real.map((real, index) => real * Math.cos(turn) - one.imaginary[index]! * Math.sin(turn));
  const whirl = whirlInWords(mode.whirl);
  const words = `${number(mode.frequency_hz)} Hz`;
  return (
    <figure>
      <figcaption>
        <strong>{words}</strong>
        {mode.standard_error_hz !== null && <span class="muted"> ± {number(1.96 * mode.standard_error_hz, 2)}</span>},{" "}
        <span class="muted">
          damping {number(100 * mode.damping_ratio)} %, {whirl}
          {mode.damping_ratio < 0 && ", unstable"}
        </span>
      </figcaption>
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={`Mode shape at ${words}, ${whirl}`}>
        <path class="grid" d={`M${MARGIN} ${HEIGHT / 2}H${WIDTH - MARGIN}`} />
        {drawing.couplings.map((one) => (
          <path class="grid dotted" d={`M${at(one.at)} 6V${HEIGHT - 6}`} />
        ))}
        {drawing.bearings.map((one) => (
          <path class="foot" d={`M${at(one.at)} ${HEIGHT - 16}l-5 9h10z`} />
        ))}
        {mode.shafts.map((shaft) => (
          <g key={shaft.shaft}>
            <path class="hull" d={`${line(shaft.at, shaft.semi_major)}${line([...shaft.at].reverse(), [...shaft.semi_major].reverse().map((one) => -one)).replace("M", "L")}Z`} />
            <g class="curve s0">
              <path d={line(shaft.at, now(shaft.x))} />
            </g>
            <g class="curve s1 dashed">
              <path d={line(shaft.at, now(shaft.y))} />
            </g>
          </g>
        ))}
      </svg>
    </figure>
  );
}

/** Phase [rad] of the largest displacement: turned back by it, the shape is seen at its largest. */
function phaseOfLargest(mode: ModeShape): number {
  let largest = 0;
  let phase = 0;
  for (const shaft of mode.shafts) {
    for (const one of [shaft.x, shaft.y]) {
      one.real.forEach((real, index) => {
        const size = Math.hypot(real, one.imaginary[index]!);
        if (size > largest) [largest, phase] = [size, Math.atan2(one.imaginary[index]!, real)];
      });
    }
  }
  return phase;
}
