// The content of a report of one machine and period.
import { PendingPanel } from "../components/newest-identification";
import { Panel } from "../components/panel";
import { useAlertsAt } from "../data/alerts-at-time";
import { queryString } from "../data/http-client";
import { useNewestOf } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { elementKind } from "../format/names";
import { IdentificationPanels } from "../identification/identification-panels";
import { OilFilmsPanel } from "../identification/oil-films-panel";
import { t } from "../messages/messages";
import { ElementHistories } from "../panels/element-histories";
import type { Alert } from "../schemas/alerts";
import type { Identification, IdentificationSummary } from "../schemas/identifications";
import type { Document, TimelineEntry } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import { wasOpenAt } from "../words/alert-states";
import { elementsOfEstimates } from "../words/elements";
import { ResponseOfReport } from "./report-response";
import { AlertsOfPeriod, MarkedTrain, Summary, TimelineOfPeriod, WhatToDo } from "./report-panels";

/** The API's limit for a page of any list. */
const LIMIT = 1000;

export function ReportBody({ machine, from, to }: { machine: Document; from: string; to: string }) {
  const period = queryString({ from, to, limit: LIMIT });
  const alerts = useResource<Alert[]>(`/machines/${machine.id}/alerts?limit=${LIMIT}`);
  const runs = useResource<Run[]>(`/machines/${machine.id}/runs${period}`);
  const timeline = useResource<TimelineEntry[]>(`/machines/${machine.id}/timeline${period}`);
  const identifications = useResource<IdentificationSummary[]>(`/machines/${machine.id}/identifications${period}`);
  const found = useNewestOf(identifications.data);
  const newest = found.data;
  const then = useAlertsAt(alerts.data, to);
  const during = (then.data ?? []).filter((one) => one.opened_at <= to && (one.closed_at ?? to) >= from);
  const isTruncated = [alerts, runs, timeline, identifications].some((one) => one.data?.length === LIMIT);
  const isPending = !newest && identifications.data?.length !== 0;
  return (
    <>
      <Panel title={t("summary")}>
        <Summary runs={runs.data} identifications={identifications.data} alerts={then.data && during} to={to} />
        {isTruncated && <p class="muted">{t("newestCounted", { limit: LIMIT })}</p>}
        {identifications.data?.length === 0 && <p class="muted">{t("noIdentificationInThisPeriod")}</p>}
        <MarkedTrain machine={machine} newest={newest} open={during.filter((one) => wasOpenAt(one, to))} />
      </Panel>
      <WhatToDo open={during.filter((one) => wasOpenAt(one, to))} />
      <AlertsOfPeriod
        result={{ data: then.data, failure: alerts.failure ?? then.failure, asOf: alerts.asOf ?? then.asOf }}
        alerts={during}
      />
      <TimelineOfPeriod result={timeline} />
      {newest && <Histories machine={machine} newest={newest} from={from} to={to} alerts={then.data ?? []} during={during} />}
      {newest && <ResponseOfReport machine={machine} newest={newest} open={during.filter((one) => wasOpenAt(one, to))} />}
      {isPending && <PendingPanel title={t("identification")} failure={found.failure ?? identifications.failure} />}
      {newest && <IdentificationPanels machine={machine} found={newest} />}
      {newest && <OilFilmsPanel machine={machine} found={newest} showsAll />}
    </>
  );
}

interface HistoriesProps {
  machine: Document;
  newest: Identification;
  from: string;
  to: string;
  alerts: Alert[];
  during: Alert[];
}

/** The histories of all couplings, and of every element that had an alert. */
function Histories({ machine, newest, from, to, alerts, during }: HistoriesProps) {
  const elements = elementsOfEstimates(newest.estimates).filter(
    (one) => elementKind(one) === "coupling" || during.some((alert) => alert.element === one),
  );
  return (
    <>
      {elements.map((element) => (
        <ElementHistories
          key={element}
          machine={machine.id}
          rotation={machine.rotation}
          element={element}
          names={newest.estimates.filter((one) => one.element === element).map((one) => one.parameter)}
          newest={newest}
          from={from}
          to={to}
          scope="run"
          alerts={alerts}
          height={190}
        />
      ))}
    </>
  );
}
