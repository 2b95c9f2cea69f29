// The parts of a report: summary with the train as it was, alerts and timeline of the period.
import { ErrorMessage, Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Severity } from "../components/severity";
import { useSpeedText } from "../components/speed";
import { Time } from "../components/time";
import { isComparable } from "../data/newest-identification";
import { useResource, type QueryResult } from "../data/resource";
import { elementName } from "../format/names";
import { rich, stored, t, term } from "../messages/messages";
import { AlertAdvice } from "../panels/alert-advice";
import type { Alert } from "../schemas/alerts";
import type { Identification, IdentificationSummary } from "../schemas/identifications";
import type { Document, Drawing, TimelineEntry } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import type { Deviations } from "../schemas/trends";
import { elementMarks } from "../train/marks";
import { TrainDrawing } from "../train/train-drawing";
import { TrainLegend } from "../train/train-legend";
import { alertStateLabel, alertTitle, wasOpenAt } from "../words/alert-states";

interface SummaryProps {
  runs: Run[] | undefined;
  identifications: IdentificationSummary[] | undefined;
  alerts: Alert[] | undefined;
  to: string;
}

export function Summary({ runs, identifications, alerts, to }: SummaryProps) {
  const speedText = useSpeedText();
  const accepted = identifications?.filter((one) => one.accepted).length;
  const speeds = (runs ?? []).map((one) => one.speed_maximum_rpm ?? 0);
  return (
    <p>
      {t("reportSummary", {
        runs: counted(runs?.length, "oneRun", "manyRuns"),
        speed: speeds.length > 0 && t("upToSpeed", { speed: speedText(Math.max(...speeds)) }),
        identifications: counted(identifications?.length, "oneIdentification", "manyIdentifications"),
        accepted: accepted ?? "…",
        alerts: counted(alerts?.length, "oneAlert", "manyAlerts"),
        open: alerts?.filter((one) => wasOpenAt(one, to)).length ?? "…",
      })}
    </p>
  );
}

type One = "oneRun" | "oneIdentification" | "oneAlert";
type Many = "manyRuns" | "manyIdentifications" | "manyAlerts";

function counted(count: number | undefined, one: One, many: Many): string {
  return t(count === 1 ? one : many, { count: count ?? "…" });
}

/** The train as it was at the end of the period. */
export function MarkedTrain({ machine, newest, open }: { machine: Document; newest: Identification | undefined; open: Alert[] }) {
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  const deviations = useResource<Deviations>(isComparable(newest) ? `/machines/${machine.id}/deviations?identification=${newest.id}` : null);
  const isPending = isComparable(newest) && !deviations.data && !deviations.failure?.isLocal;
  return (
    <Loaded result={isPending ? { data: undefined, failure: drawing.failure } : drawing} lines={15}>
      {(found) => (
        <>
          <TrainLegend />
          <TrainDrawing name={machine.name} drawing={found} marks={elementMarks(open, deviations.data)} onChoose={() => undefined} />
          {!deviations.data && deviations.failure && <ErrorMessage failure={deviations.failure} />}
          <MarksNote deviations={deviations.data} />
        </>
      )}
    </Loaded>
  );
}

function MarksNote({ deviations }: { deviations: Deviations | undefined }) {
  return (
    <p class="muted">
      {deviations && !deviations.missing && (
        <>
          {rich("changesOfIdentification", { id: deviations.identification, time: <Time at={deviations.measured_at} /> })}{" "}
        </>
      )}
      {t("alertsOpenAtEnd", { changes: deviations?.missing && t("noChangesAreMarked", { missing: stored(deviations.missing) }) })}
    </p>
  );
}

export function AlertsOfPeriod({ result, alerts }: { result: QueryResult<Alert[]>; alerts: Alert[] }) {
  return (
    <Panel title={t("alertsOfThePeriod")}>
      <Loaded result={result}>{() => <AlertTable alerts={alerts} />}</Loaded>
    </Panel>
  );
}

/** Advice on each alert that was open at the end: how far, how urgent, what to do. */
export function WhatToDo({ open }: { open: Alert[] }) {
  const advised = open.filter((one) => one.advice);
  if (advised.length === 0) return null;
  return (
    <Panel title={t("whatIsToBeDone")}>
      {advised.map((one) => (
        <section key={one.id}>
          <h3>
            <Severity severity={one.severity} /> {alertTitle(one)}
          </h3>
          <AlertAdvice advice={one.advice!} />
        </section>
      ))}
    </Panel>
  );
}

function AlertTable({ alerts }: { alerts: Alert[] }) {
  if (alerts.length === 0) return <Empty>{t("noAlertInThisPeriod")}</Empty>;
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th title={t("atTheEndOfThe")}>{t("severity")}</th>
            <th title={t("atTheEndOfThe")}>{t("message")}</th>
            <th>{t("element")}</th>
            <th title={t("atTheEndOfThe")}>{t("state")}</th>
            <th>{t("opened")}</th>
            <th>{t("closed")}</th>
          </tr>
        </thead>
        <tbody>
          {alerts.map((one) => (
            <tr key={one.id}>
              <td>
                <Severity severity={one.severity} />
              </td>
              <td>{one.message}</td>
              <td>{elementName(one.element)}</td>
              <td>{alertStateLabel(one.state)}</td>
              <td>
                <Time at={one.opened_at} />
              </td>
              <td>
                <Time at={one.closed_at} />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

export function TimelineOfPeriod({ result }: { result: QueryResult<TimelineEntry[]> }) {
  return (
    <Panel title={t("notesAndMaintenance")}>
      <Loaded result={result}>
        {(entries) =>
          entries.length === 0 ? (
            <Empty>{t("noNotesOrMaintenanceIn")}</Empty>
          ) : (
            <ul>
              {entries.map((one) => (
                <li key={one.id}>
                  <Time at={one.at} /> {term(one.kind)}, {one.by}: {one.text}
                </li>
              ))}
            </ul>
          )
        }
      </Loaded>
    </Panel>
  );
}
