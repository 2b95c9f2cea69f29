// All alerts of all machines.
import type { Alert } from "./answers";
import { Alerts } from "./alerts";
import { query } from "./api";
import { Cut, Panel } from "./parts";
import { useResource } from "./resource";
import { choose, place } from "./router";
import { useStore } from "./store";

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
