// A list of alerts, each with its evidence and history, and the actions on it.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty } from "../components/panel";
import type { QueryResult } from "../data/resource";
import { AlertActionDialog } from "../dialogs/alert-action-dialog";
import type { Alert } from "../schemas/alerts";
import type { AlertAction } from "../words/alert-states";
import { AlertEntry } from "./alert-entry";

export function AlertList(props: { result: QueryResult<Alert[]>; machines?: boolean; opened?: boolean; none: string }) {
  const [dialog, setDialog] = useState<{ alert: Alert; action: AlertAction } | null>(null);
  return (
    <>
      <Loaded result={props.result} lines={4}>
        {(alerts) =>
          alerts.length === 0 ? (
            <Empty>{props.none}</Empty>
          ) : (
            <ul class="alerts">
              {alerts.map((alert) => (
                <AlertEntry
                  key={alert.id}
                  alert={alert}
                  machine={props.machines ?? false}
                  opened={props.opened ?? false}
                  onAction={(action) => setDialog({ alert, action })}
                />
              ))}
            </ul>
          )
        }
      </Loaded>
      {dialog && <AlertActionDialog alert={dialog.alert} action={dialog.action} onClose={() => setDialog(null)} />}
    </>
  );
}
