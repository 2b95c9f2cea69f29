// What the identified model says: critical speeds, Campbell diagram, coupling loads over speed, a balancing proposal.
import type { Balancing, Campbell, CriticalSpeeds, Document, Identification, MisalignmentForce } from "../schemas/answers";
import { angleSense, number, rpm, scaleOf, whirlInWords } from "../words/format";
import { Empty, Panel, Shown, Time } from "../components/parts";
import { Plot, type Curve } from "../plots/plot";
import { useResource } from "../data/resource";
import { Awaited, Behind, NotIdentified, useNewest } from "../data/newest-identification";

/** Modes damped more than this are not felt in passing, and left out of the diagram. */
const HEAVY = 0.5;

function pathsOf(id: number) {
  const of = `/identifications/${id}/model`;
  return { campbell: `${of}/campbell`, criticals: `${of}/critical-speeds`, forces: `${of}/misalignment-force`, balancing: `${of}/balancing` };
}

export function ModelView({ machine }: { machine: Document }) {
  const { newest, none, failure, listed } = useNewest(machine.id, (id) => Object.values(pathsOf(id)));
  if (none) return <NotIdentified />;
  if (!newest) return <Awaited title="Model" failure={failure} />;
  return (
    <>
      <Behind failure={failure} listed={listed} />
      <Model machine={machine} newest={newest} />
    </>
  );
}

function Model({ machine, newest }: { machine: Document; newest: Identification }) {
  const paths = pathsOf(newest.id);
  return (
    <>
      <p class="muted">
        The model of identification {newest.id}, measured <Time at={newest.measured_at} /> in a {newest.run_kind}.
      </p>
      <div class="columns">
        <CampbellPanel machine={machine} path={paths.campbell} />
        <Criticals machine={machine} path={paths.criticals} />
      </div>
      <Forces path={paths.forces} />
      <BalancingPanel path={paths.balancing} />
    </>
  );
}

function CampbellPanel({ machine, path }: { machine: Document; path: string }) {
  const answer = useResource<Campbell>(path);
  return (
    <Panel title="Campbell diagram" aside={<p class="muted">Natural frequencies over speed; dotted: 1×</p>}>
      <Shown answer={answer} lines={24}>
        {(found) => (
          <Plot
            label={`Campbell diagram with ${found.curves.length} modes`}
            x={found.speed}
            xUnit="rpm"
            yUnit="Hz"
            height={380}
            curves={campbellCurves(found)}
            markers={[
              ...found.critical_speeds.map((one) => ({ x: one.speed, kind: "speed" as const, words: "critical speed" })),
            ]}
            readOut={(index) => campbellWords(found, index)}
          />
        )}
      </Shown>
      <p class="muted">
        Solid: forward whirl or planar, dashed: backward. Vertical lines: critical speeds. The machine runs to {rpm(machine.speed_range.maximum_rpm)}.
      </p>
    </Panel>
  );
}

function campbellCurves(found: Campbell): Curve[] {
  const modes = found.curves.flatMap((one, at): Curve[] => {
    const felt = one.frequency_hz.map((value, index) => ((one.damping_ratio[index] ?? 1) < HEAVY ? value : null));
    if (felt.every((value) => value === null)) return [];
    const mean = one.whirl.reduce<number>((sum, value) => sum + (value ?? 0), 0) / one.whirl.length;
    return [{ name: `mode ${at + 1}`, style: whirlInWords(mean) === "backward" ? 1 : 0, y: felt, aside: true }];
  });
  return [{ name: "1×", style: 2, y: found.synchronous_hz, aside: true }, ...modes];
}

function campbellWords(found: Campbell, index: number): string {
  const there = found.curves
    .map((one) => ({ hz: one.frequency_hz[index], damping: one.damping_ratio[index] }))
    .filter((one) => one.hz !== null && one.hz !== undefined && (one.damping ?? 1) < HEAVY)
    .map((one) => `${number(one.hz)}`);
  return `${rpm(found.speed[index])}: ${there.join(", ")} Hz`;
}

function Criticals({ machine, path }: { machine: Document; path: string }) {
  const answer = useResource<CriticalSpeeds>(path);
  const { minimum_rpm: low, maximum_rpm: high } = machine.speed_range;
  return (
    <Panel title="Critical speeds" aside={<p class="muted">with 95 % intervals</p>}>
      <Shown answer={answer} lines={10}>
        {(found) =>
          found.critical_speeds.length === 0 ? (
            <Empty>None up to {rpm(found.highest)}.</Empty>
          ) : (
            <div class="scroll">
              <table>
                <thead>
                  <tr>
                    <th class="number">Speed</th>
                    <th class="number">Interval</th>
                    <th class="number">Damping ratio</th>
                    <th class="number">Log. decrement</th>
                    <th>Whirl</th>
                    <th>Lies</th>
                  </tr>
                </thead>
                <tbody>
                  {found.critical_speeds.map((one) => (
                    <tr key={one.speed}>
                      <td class="number">{rpm(one.speed)}</td>
                      <td class="number muted">
                        {one.lower === null ? "–" : Math.round(one.lower)} … {one.upper === null ? "–" : Math.round(one.upper)}
                      </td>
                      <td class="number">{number(100 * one.damping_ratio)} %</td>
                      <td class="number">{number(one.log_decrement)}</td>
                      <td>{whirlInWords(one.whirl)}</td>
                      <td>{one.speed < low ? "below the range" : one.speed > high ? "above the range" : "in the range"}</td>
                    </tr>
                  ))}
                </tbody>
              </table>
            </div>
          )
        }
      </Shown>
    </Panel>
  );
}

const LOADS = [
  ["force_x", "Force along x", "N"],
  ["force_y", "Force along y", "N"],
  ["moment_x", "Moment about x", "N m"],
  ["moment_y", "Moment about y", "N m"],
] as const;

function Forces({ path }: { path: string }) {
  const answer = useResource<MisalignmentForce>(path);
  return (
    <Panel title="What the couplings carry at 1×, over speed" aside={<p class="muted">0-to-peak, bands are 95 %</p>}>
      <Shown answer={answer} lines={16}>
        {(found) =>
          found.couplings.length === 0 ? (
            <Empty>The train has no coupling.</Empty>
          ) : (
            <div class="plots">
              {found.couplings.flatMap((coupling) =>
                LOADS.map(([field, words, unit]) => {
                  const load = coupling[field];
                  const scale = scaleOf(Math.max(0, ...load.amplitude.map((one) => one ?? 0)), unit);
                  const scaled = (column: (number | null)[]) => column.map((one) => (one === null ? null : one * scale.factor));
                  return (
                    <figure key={coupling.coupling + field}>
                      <figcaption>
                        <strong>{coupling.coupling}</strong> {words} [{scale.unit}]
                      </figcaption>
                      <Plot
                        label={`${words} in coupling ${coupling.coupling} over speed`}
                        x={found.speed}
                        xUnit="rpm"
                        yUnit={scale.unit}
                        height={170}
                        together="forces"
                        curves={[{ name: words, style: field.endsWith("x") ? 0 : 1, y: scaled(load.amplitude), lower: scaled(load.lower), upper: scaled(load.upper) }]}
                      />
                    </figure>
                  );
                }),
              )}
            </div>
          )
        }
      </Shown>
    </Panel>
  );
}

function BalancingPanel({ path }: { path: string }) {
  const answer = useResource<Balancing>(path);
  return (
    <Panel title="Balancing proposal" aside={<p class="muted">Unbalance to add, from the identified model, without trial weights; what is left is the model's uncertainty</p>}>
      <Shown answer={answer} lines={8}>
        {(found) => (
          <div class="columns">
            <div class="scroll">
              <table>
                <thead>
                  <tr>
                    <th>Plane</th>
                    <th class="number">To add</th>
                    <th class="number">At, {angleSense(found.direction)}</th>
                  </tr>
                </thead>
                <tbody>
                  {found.corrections.map((one) => (
                    <tr key={one.plane}>
                      <td>{one.plane}</td>
                      <td class="number">{number(one.unbalance_g_mm)} g·mm</td>
                      <td class="number">{Math.round(one.angle_deg)}°</td>
                    </tr>
                  ))}
                </tbody>
              </table>
            </div>
            <div class="scroll">
              <table>
                <thead>
                  <tr>
                    <th>Channel</th>
                    <th class="number">Largest now</th>
                    <th class="number">Largest then, 95 %</th>
                  </tr>
                </thead>
                <tbody>
                  {found.before.map((one, at) => (
                    <tr key={one.channel}>
                      <td>{one.channel}</td>
                      <td class="number">{number(largest(one.amplitude))} µm pp</td>
                      <td class="number">below {number(largest(found.after[at]?.upper ?? []))} µm pp</td>
                    </tr>
                  ))}
                </tbody>
              </table>
            </div>
          </div>
        )}
      </Shown>
    </Panel>
  );
}

function largest(column: (number | null)[]): number {
  return Math.max(0, ...column.map((one) => one ?? 0));
}
