// The machine at a glance: the train with what has changed, its alerts, its newest runs.
import type { Alert, Deviations, Document, Drawing, Run } from "../schemas/answers";
import { Alerts } from "../panels/alert-list";
import { query, type Failure } from "../data/http-client";
import { marksOf } from "../train/marks";
import { DeviationsPanel } from "../panels/deviations-panel";
import { useLastWhole } from "../data/last-complete";
import { LiveRun } from "../panels/live-run-panel";
import { number, rpm } from "../words/format";
import { comparable, noneAccepted, useNewestSummary, type NewestSummary } from "../data/newest-identification";
import { Cut, Empty, Panel, Shown, Time } from "../components/parts";
import { useResource, type Answer } from "../data/resource";
import { go, link } from "../browser/router";
import { Timeline } from "../panels/timeline-panel";
import { Train } from "../train/train-drawing";

const MOST_ALERTS = 200;

/** Where a machine's open alerts are asked for. */
export function openAlerts(machine: string): string {
  return `/machines/${machine}/alerts${query({ open: true, limit: MOST_ALERTS })}`;
}

export function Overview({ machine }: { machine: Document }) {
  const alerts = useResource<Alert[]>(openAlerts(machine.id), 10_000);
  const summary = useNewestSummary(machine.id);
  const { deviations, next } = useDeviations(machine.id, summary);
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  return (
    <>
      <Panel title="Train" aside={<Legend />}>
        <Shown answer={drawing} lines={15}>
          {(found) => (
            <Train
              name={machine.name}
              drawing={found}
              marks={marksOf(alerts.data ?? [], deviations.data)}
              chosen={null}
              onChoose={(element) => go(["machines", machine.id, "trends"], { element })}
            />
          )}
        </Shown>
      </Panel>
      <div class="columns">
        <div>
          <Panel title="Open alerts">
            <Alerts answer={alerts} none="No alert is open." />
            <Cut shown={alerts.data?.length ?? 0} most={MOST_ALERTS} />
          </Panel>
          <LiveRun machine={machine} />
        </div>
        <div>
          <DeviationsPanel machine={machine} answer={deviations} next={next} none={noneAccepted(summary)} />
          <Timeline machine={machine} />
        </div>
      </div>
      <Runs machine={machine} />
    </>
  );
}

/** How the newest identification compares, or the one before it until that is known; then why it is not known, of the next. */
function useDeviations(machine: string, { data: newest, failure, asOf }: NewestSummary): { deviations: Answer<Deviations>; next: Failure | undefined } {
  const found = useResource<Deviations>(comparable(newest) ? `/machines/${machine}/deviations?identification=${newest.id}` : null);
  const before = useLastWhole(machine, found.data);
  if (found.data || found.failure?.refused || !before || !comparable(newest)) {
    return { deviations: { data: found.data, failure: found.failure ?? failure, asOf: found.asOf ?? asOf }, next: undefined };
  }
  return { deviations: { data: before, failure, asOf }, next: found.failure };
}

export function Legend() {
  return (
    <p class="legend muted">
      <span class="normal">■</span> as at the baseline <span class="unknown">▢</span> not known <span class="changed">●</span> changed <span class="alert">▲</span> alert{" "}
      <span class="danger">◆</span> danger
    </p>
  );
}

function Runs({ machine }: { machine: Document }) {
  const answer = useResource<Run[]>(`/machines/${machine.id}/runs?limit=12`, 5000);
  return (
    <Panel title="Newest runs">
      <Shown answer={answer} lines={12}>
        {(runs) =>
          runs.length === 0 ? (
            <Empty>No run yet. One begins when the speed sweeps through the machine's range.</Empty>
          ) : (
            <div class="scroll">
              <table>
                <thead>
                  <tr>
                    <th>Run</th>
                    <th>Began</th>
                    <th>Kind</th>
                    <th class="number">Speeds</th>
                    <th class="number">Samples</th>
                    <th class="number">Usable</th>
                    <th>State</th>
                  </tr>
                </thead>
                <tbody>
                  {runs.map((run) => (
                    <tr key={run.id}>
                      <td>
                        <a href={link(["machines", machine.id, "response"], { run: String(run.id) })}>{run.id}</a>
                      </td>
                      <td>
                        <Time at={run.started_at} />
                      </td>
                      <td>{run.kind}</td>
                      <td class="number">
                        {rpm(run.speed_minimum_rpm).replace(" rpm", "")} … {rpm(run.speed_maximum_rpm)}
                      </td>
                      <td class="number">{run.samples ?? "–"}</td>
                      <td class="number">
                        {run.quality ? `${number((100 * run.quality.usable) / Math.max(1, run.quality.points))} %` : "–"}
                      </td>
                      <td title={run.reason ?? undefined}>{run.state}</td>
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
