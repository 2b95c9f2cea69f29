// All machines: what they do, what is open, what changed since yesterday.
import type { Fleet as FleetAnswer, FleetMachine } from "../schemas/answers";
import { rpm, when } from "../words/format";
import { Cut, Empty, Mode, Panel, Severity, Shown, Time } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, link, place } from "../browser/router";
import { useStore } from "../browser/store";

const MS = 5000;
/** The service answers with so many at most. */
const SHOWN = 1000;
const SEVERITIES = ["danger", "alert"];

type Order = "urgency" | "name" | "plant";

export function Fleet() {
  const { query } = useStore(place);
  const answer = useResource<FleetAnswer>("/fleet", MS);
  const sought = (query.get("sought") ?? "").toLowerCase();
  const order = (query.get("order") ?? "urgency") as Order;
  return (
    <>
      <h1>Fleet</h1>
      <Panel
        title="Machines"
        aside={
          <div class="choices">
            <label class="switch">
              Find <input type="search" value={sought} size={14} onInput={(event) => choose({ sought: event.currentTarget.value || null })} />
            </label>
            <label class="switch">
              By{" "}
              <select value={order} onChange={(event) => choose({ order: event.currentTarget.value })}>
                <option value="urgency">urgency</option>
                <option value="name">name</option>
                <option value="plant">plant</option>
              </select>
            </label>
          </div>
        }
      >
        <Shown answer={answer} lines={12}>
          {({ machines, since }) => (
            <>
              <Totals machines={machines} />
              <Cut shown={machines.length} most={SHOWN} what="first" />
              <Table machines={sorted(machines.filter((one) => fits(one, sought)), order)} all={machines.length} since={since} />
            </>
          )}
        </Shown>
      </Panel>
    </>
  );
}

function fits(one: FleetMachine, sought: string): boolean {
  return `${one.plant} ${one.id} ${one.name}`.toLowerCase().includes(sought);
}

function urgency(one: FleetMachine): number {
  return 1e6 * (one.open_alerts.danger ?? 0) + 1e3 * (one.open_alerts.alert ?? 0) + one.unacknowledged;
}

function sorted(machines: FleetMachine[], order: Order): FleetMachine[] {
  const by = { urgency: (a: FleetMachine, b: FleetMachine) => urgency(b) - urgency(a) || a.name.localeCompare(b.name), name: (a: FleetMachine, b: FleetMachine) => a.name.localeCompare(b.name), plant: (a: FleetMachine, b: FleetMachine) => a.plant.localeCompare(b.plant) || a.name.localeCompare(b.name) };
  return [...machines].sort(by[order]);
}

function Totals({ machines }: { machines: FleetMachine[] }) {
  const open = (severity: string) => machines.filter((one) => (one.open_alerts[severity] ?? 0) > 0).length;
  const turning = machines.filter((one) => !["stopped", "unknown"].includes(one.state)).length;
  const unseen = machines.reduce((sum, one) => sum + one.unacknowledged, 0);
  const figures: [number, string][] = [
    [machines.length, machines.length === 1 ? "machine" : "machines"],
    [turning, "turning"],
    [machines.filter((one) => one.open_run).length, "in a run"],
    [open("danger"), "in danger"],
    [open("alert"), "with an alert"],
    [unseen, "alerts not acknowledged"],
  ];
  return (
    <dl class="totals">
      {figures.map(([count, words]) => (
        <div key={words}>
          <dd class="figure">{count}</dd>
          <dt>{words}</dt>
        </div>
      ))}
    </dl>
  );
}

function Table({ machines, all, since }: { machines: FleetMachine[]; all: number; since: string }) {
  if (all === 0) {
    return (
      <Empty>
        No machine yet. A machine is created from its document: <code>rundown document examples/motor-pump.yaml | curl -X POST …/api/v1/machines …</code>
      </Empty>
    );
  }
  if (machines.length === 0) return <Empty>No machine is called so.</Empty>;
  return (
    <div class="scroll">
      <table class="fleet">
        <thead>
          <tr>
            <th>Open</th>
            <th>Machine</th>
            <th>State</th>
            <th class="number">Speed</th>
            <th>Last run</th>
            <th>Last identification</th>
            <th title={`since ${when(since)}`}>Since yesterday</th>
          </tr>
        </thead>
        <tbody>
          {machines.map((one) => (
            <Row key={one.id} one={one} />
          ))}
        </tbody>
      </table>
    </div>
  );
}

function Row({ one }: { one: FleetMachine }) {
  const quiet = SEVERITIES.every((severity) => !one.open_alerts[severity]);
  return (
    <tr data-machine={one.id}>
      <td class="open">
        {quiet && <span class="muted">none</span>}
        {SEVERITIES.filter((severity) => one.open_alerts[severity]).map((severity) => (
          <span key={severity}>
            <Severity severity={severity} seen={one.unacknowledged === 0} /> {one.open_alerts[severity]}
          </span>
        ))}
        {one.unacknowledged > 0 && <span class="pill">{one.unacknowledged} new</span>}
      </td>
      <td>
        <a href={link(["machines", one.id])}>{one.name}</a>
        <div class="muted">
          {one.plant} / {one.id}
        </div>
      </td>
      <td>
        <Mode state={one.state} />
        <div class="muted">
          <Time at={one.state_since} />
        </div>
      </td>
      <td class="number">{rpm(one.speed_rpm)}</td>
      <td>
        {one.open_run ? (
          <label class="collecting">
            {one.open_run.kind} <progress max={1} value={one.open_run.progress} aria-label={`run ${one.open_run.id} is being collected`} />
          </label>
        ) : one.last_run ? (
          <>
            {one.last_run.kind}
            <div class="muted">
              <Time at={one.last_run.started_at} />
            </div>
          </>
        ) : (
          <span class="muted">none</span>
        )}
      </td>
      <td title={one.last_identification?.verdict}>
        {one.last_identification ? (one.last_identification.accepted ? "accepted" : "✕ not accepted") : <span class="muted">none</span>}
        <div class="muted">{one.last_identification && <Time at={one.last_identification.measured_at} />}</div>
      </td>
      <td>{changes(one)}</td>
    </tr>
  );
}

const CHANGES: [keyof FleetMachine["happened"], string, string][] = [
  ["alert_events", "alert event", "alert events"],
  ["runs", "run", "runs"],
  ["identifications", "identification", "identifications"],
  ["timeline", "note", "notes"],
  ["revisions", "revision of the document", "revisions of the document"],
];

function changes({ happened }: FleetMachine) {
  const said = CHANGES.filter(([what]) => happened[what] > 0).map(([what, one, many]) => `${happened[what]} ${happened[what] === 1 ? one : many}`);
  return said.length > 0 ? said.join(", ") : <span class="muted">nothing</span>;
}
