// One alert on one page: what it says and what to do, the train, the trends of what changed, the response beside it.
import { link } from "../browser/router";
import { Loaded } from "../components/loading";
import { MissingAlert } from "../components/missing";
import { Panel } from "../components/panel";
import { useLastComplete } from "../data/last-complete";
import { useDeviations } from "../data/machine-deviations";
import { useNewestSummary } from "../data/newest-identification";
import { useOpenAlerts } from "../data/open-alerts";
import { useResource } from "../data/resource";
import { when } from "../format/times";
import { rich, t, term } from "../messages/messages";
import { AlertList } from "../panels/alert-list";
import { ElementHistories } from "../panels/element-histories";
import type { Alert } from "../schemas/alerts";
import type { Identification } from "../schemas/identifications";
import type { Document, Drawing, MachineRevision } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import { elementMarks } from "../train/marks";
import { nearestChannels } from "../train/nearest-probes";
import { TrainDrawing } from "../train/train-drawing";
import { alertTitle } from "../words/alert-states";
import { RunResponse } from "../identification/run-response";

/** Trends shown beside an alert: those that moved most. */
const MOST_TRENDS = 4;
const NUMBER = /^\d{1,15}$/;

export function AlertPage({ id }: { id: string }) {
  const isNumber = NUMBER.test(id);
  const result = useResource<Alert>(isNumber ? `/alerts/${id}` : null, 10_000);
  const machine = useResource<MachineRevision>(result.data ? `/machines/${result.data.machine}` : null);
  if (!isNumber || result.failure?.status === 404) return <MissingAlert id={id} />;
  return (
    <Loaded result={result} lines={20}>
      {(alert) => (
        <>
          <header class="alert-title">
            <h1>
              {alertTitle(alert)}
            </h1>
            <p class="buttons">
              <a href={link(["machines", alert.machine])}>{machine.data?.document.name ?? alert.machine}</a>
              <a href={link(["reports", alert.machine])}>{t("report")}</a>
              <a href={link(["alerts"])}>{t("allAlerts")}</a>
            </p>
          </header>
          <Panel title={t("whatItSays")}>
            <AlertList result={{ ...result, data: [alert] }} machines opened none="" />
          </Panel>
          <Loaded result={machine} lines={20}>
            {({ document }) => <AlertEvidence alert={alert} machine={document} />}
          </Loaded>
        </>
      )}
    </Loaded>
  );
}

function AlertEvidence({ alert, machine }: { alert: Alert; machine: Document }) {
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  const identified = useResource<Identification>(`/identifications/${alert.identification}`);
  // A later run that shows the alert as well takes nothing away that is being looked at.
  const shown = useLastComplete(alert.id, identified.data);
  return (
    <>
      <TrainWithAlerts machine={machine} drawing={drawing.data} />
      <Loaded result={{ ...identified, data: shown }} lines={15}>
        {(found) => (
          <>
            <MovedTrends alert={alert} machine={machine} found={found} />
            <ResponseBesideBaseline alert={alert} machine={machine} drawing={drawing.data} found={found} />
          </>
        )}
      </Loaded>
    </>
  );
}

function TrainWithAlerts({ machine, drawing }: { machine: Document; drawing: Drawing | undefined }) {
  const alerts = useOpenAlerts(machine.id);
  const { deviations } = useDeviations(machine.id, useNewestSummary(machine.id));
  if (!drawing) return null;
  return (
    <Panel title={t("whereItIs")}>
      <TrainDrawing
        name={machine.name}
        drawing={drawing}
        marks={elementMarks(alerts.data ?? [], deviations.data)}
        onChoose={(element) => (window.location.hash = link(["machines", machine.id, "trends"], { element }))}
      />
    </Panel>
  );
}

/** The histories of the element's parameters that moved most; of all where the alert names none. */
function MovedTrends({ alert, machine, found }: { alert: Alert; machine: Document; found: Identification }) {
  const own = found.estimates.filter((one) => one.element === alert.element).map((one) => one.parameter);
  const moved = (alert.evidence.moved ?? []).map((one) => own.find((name) => one.parameter === name || one.parameter.startsWith(`${name}.`)));
  const named = [...new Set(moved.filter((one) => one !== undefined))];
  const names = (named.length > 0 ? named : own).slice(0, MOST_TRENDS);
  if (names.length === 0) return null;
  return (
    <ElementHistories machine={machine.id} rotation={machine.rotation} element={alert.element} names={names} newest={found} scope="run" alerts={[alert]} />
  );
}

/** The run that shows it, beside the first run of the baseline that it was compared with. */
function ResponseBesideBaseline({ alert, machine, drawing, found }: { alert: Alert; machine: Document; drawing: Drawing | undefined; found: Identification }) {
  const newest = useResource<Run>(found.runs[0] === undefined ? null : `/runs/${found.runs[0]}`);
  const run = useLastComplete(alert.id, newest.data);
  const compared = alert.evidence.baseline?.[0];
  const baseline = useResource<Identification>(compared === undefined ? null : `/identifications/${compared}`);
  const first = baseline.data?.runs[0];
  const reference = useResource<Run>(first === undefined ? null : `/runs/${first}`);
  if (!drawing) return null;
  const channels = machine.probes.map((one) => one.id);
  const near = nearestChannels(drawing, alert.element).filter((one) => channels.includes(one));
  return (
    <>
      {run && (
        <p class="muted">
          {rich("runThatShowsTheAlert", { run: <RunLink machine={machine.id} run={run} />, reference: reference.data && rich("overlaidRunOfBaseline", { run: <RunLink machine={machine.id} run={reference.data} /> }) })}
        </p>
      )}
      <RunResponse machine={machine} run={run} reference={reference.data} channels={near.length > 0 ? near : channels.slice(0, 2)} subject={`alert ${alert.id}`} />
    </>
  );
}

function RunLink({ machine, run }: { machine: string; run: Run }) {
  return <a href={link(["machines", machine, "response"], { run: String(run.id) })}>{t("runOfTime", { id: run.id, kind: term(run.kind), time: when(run.started_at) })}</a>;
}
