// The newest runs of a machine.
import { link } from "../browser/router";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { number } from "../format/numbers";
import { stored, t, term } from "../messages/messages";
import type { Run } from "../schemas/runs";
import { IdentifyDwellsButton, MakeDwellsButton } from "./dwells-buttons";

export function NewestRunsPanel({ machine }: { machine: string }) {
  const result = useResource<Run[]>(`/machines/${machine}/runs?limit=12`, 5000);
  return (
    <Panel title={t("newestRuns")} aside={<MakeDwellsButton machine={machine} />}>
      <Loaded result={result} lines={12}>
        {(runs) =>
          runs.length === 0 ? (
            <Empty>{t("noRunYetSweep")}</Empty>
          ) : (
            <Scroll label={t("table")}>
              <table>
                <thead>
                  <tr>
                    <th>{t("run")}</th>
                    <th>{t("started")}</th>
                    <th>{t("kind")}</th>
                    <th class="number">{t("speeds")}</th>
                    <th class="number">{t("samples")}</th>
                    <th class="number">{t("usable")}</th>
                    <th>{t("state")}</th>
                  </tr>
                </thead>
                <tbody>
                  {runs.map((run) => (
                    <RunRow key={run.id} machine={machine} run={run} />
                  ))}
                </tbody>
              </table>
            </Scroll>
          )
        }
      </Loaded>
    </Panel>
  );
}

function RunRow({ machine, run }: { machine: string; run: Run }) {
  return (
    <tr>
      <td>
        <a href={link(["machines", machine, "response"], { run: String(run.id) })}>{run.id}</a>
      </td>
      <td>
        <Time at={run.started_at} />
      </td>
      <td>{term(run.kind)}</td>
      <td class="number">
        <Speed rpm={run.speed_minimum_rpm} /> … <Speed rpm={run.speed_maximum_rpm} />
      </td>
      <td class="number">{run.samples ?? "–"}</td>
      <td class="number">{run.quality ? `${number((100 * run.quality.usable) / Math.max(1, run.quality.points))} %` : "–"}</td>
      <td title={run.reason ? stored(run.reason) : undefined}>
        {term(run.state)} <IdentifyDwellsButton run={run} />
      </td>
    </tr>
  );
}
