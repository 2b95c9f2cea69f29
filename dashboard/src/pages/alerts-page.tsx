// All alerts of all machines.
import type { Alert } from "../schemas/answers";
import { Alerts } from "../panels/alert-list";
import { query } from "../data/http-client";
import { Cut, Panel } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, place } from "../browser/router";
import { useStore } from "../browser/store";

const SHOWN = 200;

export function AlertsPage() {
  const all = useStore(place).query.get("all") === "1";
  const answer = useResource<Alert[]>(`/alerts${query({ open: !all, limit: SHOWN })}`, 30_000);
  return (
    <>
      <h1>Alerts</h1>
      <Panel
        title={all ? "All, newest first" : "Open, newest first"}
        aside={
          <label class="switch">
            <input type="checkbox" checked={all} onChange={() => choose({ all: all ? null : "1" })} /> closed ones too
          </label>
        }
      >
        <Alerts answer={answer} machines none={all ? "There was never an alert." : "No alert is open."} />
        <Cut shown={answer.data?.length ?? 0} most={SHOWN} />
      </Panel>
    </>
  );
}
