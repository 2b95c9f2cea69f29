// All machines: what they do, what is open, what changed since yesterday.
import type { Alert, MachineState, MachineSummary, Run } from "./answers";
import { rpm } from "./format";
import { Empty, Mode, Panel, Severity, Shown, Time } from "./parts";
import { useResource } from "./resource";
import { link } from "./router";

export function Fleet() {
  const machines = useResource<MachineSummary[]>("/machines", 10_000);
  const alerts = useResource<Alert[]>("/alerts?open=true&limit=1000", 10_000);
  return (
    <>
      <h1>Fleet</h1>
      <Panel title="Machines">
        <Shown answer={machines} lines={8}>
          {(list) =>
            list.length === 0 ? (
              <Empty>
                No machine yet. <code>rundown document examples/motor-pump.yaml | curl -X POST …/api/v1/machines …</code> creates one.
              </Empty>
            ) : (
              <div class="scroll">
                <table class="fleet">
                  <thead>
                    <tr>
                      <th>Machine</th>
                      <th>State</th>
                      <th class="number">Speed</th>
                      <th>Open alerts</th>
                      <th>Last run</th>
                    </tr>
                  </thead>
                  <tbody>
                    {list.map((one) => (
                      <Row key={one.id} machine={one} alerts={(alerts.data ?? []).filter((alert) => alert.machine === one.id)} />
                    ))}
                  </tbody>
                </table>
              </div>
            )
          }
        </Shown>
      </Panel>
    </>
  );
}

function Row({ machine, alerts }: { machine: MachineSummary; alerts: Alert[] }) {
  const state = useResource<MachineState>(`/machines/${machine.id}/state`, 5000).data;
  const run = useResource<Run[]>(`/machines/${machine.id}/runs?limit=1`, 10_000).data?.[0];
  return (
    <tr>
      <td>
        <a href={link(["machines", machine.id])}>{machine.name}</a>
        <div class="muted">
          {machine.plant} / {machine.id}
        </div>
      </td>
      <td>{state ? <Mode state={state.state} /> : "…"}</td>
      <td class="number">{rpm(state?.speed_rpm)}</td>
      <td>
        {["danger", "alert"].map((severity) => {
          const count = alerts.filter((one) => one.severity === severity).length;
          return count > 0 && <span key={severity}>{count} <Severity severity={severity} /> </span>;
        })}
        {alerts.length === 0 && <span class="muted">none</span>}
      </td>
      <td>
        {run ? (
          <>
            <Time at={run.started_at} /> {run.kind}
          </>
        ) : (
          "–"
        )}
      </td>
    </tr>
  );
}
