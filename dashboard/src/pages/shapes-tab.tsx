// The shaft's motion: orbits at the probes for a speed of a run, and mode shapes of the identified model.
import { useState } from "preact/hooks";
import type { Document, Orbit, Orbits } from "../schemas/answers";
import { slowRollWords, useFitOf } from "../data/run-identification";
import { number, rpm } from "../words/format";
import { useLastWhole } from "../data/last-complete";
import { ModeShapes } from "../panels/mode-shapes-panel";
import { Empty, Panel, Shown, Trouble } from "../components/parts";
import { nice } from "../plots/polar-plot";
import { useResource } from "../data/resource";
import { choose, place } from "../browser/router";
import { RunChoice, useRuns, type Runs } from "../data/run-selection";
import { useStore } from "../browser/store";

const STEPS = 72;
/** The dot stands where the shaft is as the keyphasor mark passes; the gap before it shows where it comes from. */
const GAP = 4;
const SIZE = 200;
const RADIUS = 82;

export function ShapesView({ machine }: { machine: Document }) {
  const runs = useRuns(machine.id);
  return (
    <>
      <OrbitsPanel machine={machine} runs={runs} />
      <ModeShapes machine={machine} />
    </>
  );
}

function OrbitsPanel({ machine, runs }: { machine: Document; runs: Runs }) {
  const { query } = useStore(place);
  const { minimum_rpm: low, maximum_rpm: high } = machine.speed_range;
  const chosen = Number(query.get("rpm")) || Math.round((low + high) / 2);
  const [dragged, setDragged] = useState<number | null>(null);
  const { run, reference } = runs;
  const { slowRoll, failure } = useFitOf(machine.id, run);
  const without = (of: number) => (slowRoll ? `/runs/${of}/orbits?rpm=${chosen}&slow_roll=${slowRoll}` : null);
  const answer = useResource<Orbits>(run ? without(run.id) : null);
  const other = useResource<Orbits>(reference ? without(reference.id) : null);
  const isWhole = !reference || other.data || other.failure;
  const whole = useLastWhole([run?.id, reference?.id, chosen].join(), answer.data && isWhole ? { found: answer.data, other: other.data } : undefined);
  return (
    <Panel title="1× orbits at the probes">
      <div class="choices">
        <RunChoice {...runs} />
        <label class="wide">
          Speed: {rpm(dragged ?? chosen)}
          <input
            type="range"
            min={low}
            max={high}
            step={10}
            value={dragged ?? chosen}
            onInput={(event) => setDragged(Number(event.currentTarget.value))}
            onChange={(event) => {
              setDragged(null);
              choose({ rpm: event.currentTarget.value });
            }}
          />
        </label>
      </div>
      {failure?.own && <Trouble failure={failure} />}
      {runs.all?.length === 0 ? (
        <Empty>No run yet.</Empty>
      ) : !run && runs.failure ? (
        <p class="trouble" role="alert">
          {runs.failure}
        </p>
      ) : (
        <Shown answer={answer.data || !answer.failure?.own ? { ...answer, data: whole } : { ...answer, data: undefined }} lines={20}>
          {({ found, other }) => <OrbitPlots found={found} other={other} />}
        </Shown>
      )}
    </Panel>
  );
}

function OrbitPlots({ found, other }: { found: Orbits; other: Orbits | undefined }) {
  const all = [...found.orbits, ...(other?.orbits ?? [])];
  const ring = nice(Math.max(1e-6, ...all.map((one) => one.semi_major_um)) / 2);
  return (
    <>
      <p class="muted">
        x to the right, y up; 0-to-peak, rings of {number(ring)} µm; {slowRollOf(found)}. The dot is where the shaft is as
        the keyphasor mark passes; it comes out of the gap.
      </p>
      <div class="orbits shapes">
        {found.orbits.map((one) => (
          <OrbitPlot
            key={one.channels.join()}
            orbit={one}
            beside={other?.orbits.find((them) => them.channels.join() === one.channels.join())}
            ring={ring}
          />
        ))}
      </div>
      {found.orbits.length === 0 && <Empty>No station has probes that see both axes.</Empty>}
      {found.without.length > 0 && (
        <p class="muted">Without an orbit, for one axis only or no good sample: {found.without.map((one) => one.join(" and ")).join("; ")}.</p>
      )}
      {found.findings.map((one) => (
        <p key={one.code + one.channels.join()}>{one.words}</p>
      ))}
    </>
  );
}

/** Only channels that an orbit is shown of are named. */
function slowRollOf(found: Orbits): string {
  const seen = found.orbits.flatMap((one) => one.channels);
  return slowRollWords(found.slow_roll_version, seen.filter((one) => one in found.slow_roll_left_out));
}

function OrbitPlot({ orbit, beside, ring }: { orbit: Orbit; beside: Orbit | undefined; ring: number }) {
  const scale = RADIUS / (2 * ring);
  return (
    <figure>
      <figcaption>
        <strong>{orbit.channels.join(" ")}</strong> <span class="muted">{orbit.sense}</span>
      </figcaption>
      <svg
        viewBox={`${-SIZE / 2} ${-SIZE / 2} ${SIZE} ${SIZE}`}
        role="img"
        aria-label={`Orbit at ${orbit.channels.join(" and ")}: ${number(orbit.semi_major_um)} by ${number(Math.abs(orbit.semi_minor_um))} µm, ${orbit.sense}`}
      >
        <circle class="grid" r={RADIUS} />
        <circle class="grid" r={RADIUS / 2} />
        <path class="grid" d={`M${-RADIUS} 0H${RADIUS}M0 ${-RADIUS}V${RADIUS}`} />
        {beside && (
          <g class="curve faint">
            <path d={trace(beside, scale)} />
          </g>
        )}
        <g class="curve s0">
          <path d={trace(orbit, scale)} />
          <circle cx={orbit.x.real_um * scale} cy={-orbit.y.real_um * scale} r={3.5} fill="currentColor" />
        </g>
      </svg>
      <p class="muted">
        {number(orbit.semi_major_um)} ± {number(2 * orbit.semi_major_error_um, 2)} by {number(Math.abs(orbit.semi_minor_um))} ±{" "}
        {number(2 * orbit.semi_minor_error_um, 2)} µm at {rpm(orbit.speed_rpm)}
        {beside && `; the other run at ${rpm(beside.speed_rpm)}`}
      </p>
    </figure>
  );
}

function trace({ x, y }: Orbit, scale: number): string {
  const points = Array.from({ length: STEPS - GAP + 1 }, (_, step) => {
    const angle = (2 * Math.PI * step) / STEPS;
    const at = (phasor: { real_um: number; imaginary_um: number }) => phasor.real_um * Math.cos(angle) - phasor.imaginary_um * Math.sin(angle);
    return `${(at(x) * scale).toFixed(2)} ${(-at(y) * scale).toFixed(2)}`;
  });
  return `M${points.join("L")}`;
}
