// The alerts of all machines.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Panel, Truncated } from "../components/panel";
import { queryString } from "../data/http-client";
import { useResource } from "../data/resource";
import { t } from "../messages/messages";
import { AlertList } from "../panels/alert-list";
import type { Alert } from "../schemas/alerts";

const LIMIT = 200;

export function AlertsPage() {
  const all = useStore(route).query.get("all") === "1";
  const result = useResource<Alert[]>(`/alerts${queryString({ open: !all, limit: LIMIT })}`, 30_000);
  return (
    <>
      <h1>{t("alerts")}</h1>
      <Panel
        title={all ? t("allNewestFirst") : t("openNewestFirst")}
        aside={
          <label class="switch">
            <input type="checkbox" checked={all} onChange={() => replaceQuery({ all: all ? null : "1" })} /> {t("includeClosed")}
          </label>
        }
      >
        <AlertList result={result} machines none={all ? t("noAlerts") : t("noOpenAlerts")} />
        <Truncated shown={result.data?.length ?? 0} limit={LIMIT} />
      </Panel>
    </>
  );
}
