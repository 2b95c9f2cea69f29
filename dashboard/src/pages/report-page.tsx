// A report of one machine and period, to be printed or kept as a file: what happened, how the parameters went, what is open.
import { useLayoutEffect } from "preact/hooks";
import type { Alert, Deviations, Document, Drawing, Identification, IdentificationSummary, MachineRevision, Run, TimelineEntry } from "../schemas/answers";
import { query } from "../data/http-client";
import { openAt, stateInWords } from "../words/alert-states";
import { useAlertsAt } from "../data/alerts-at-time";
import { marksOf } from "../train/marks";
import { elementName, rpm } from "../words/format";
import { Identified } from "./parameters-tab";
import { Legend } from "./overview-tab";
import { Empty, Panel, Severity, Shown, Time, Trouble } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, link, place } from "../browser/router";
import { useStore } from "../browser/store";
import { onPaper } from "../browser/theme";
import { Train } from "../train/train-drawing";
import { Awaited, comparable, elementsOf, useNewestOf } from "../data/newest-identification";
import { Histories } from "./trends-tab";

const PERIOD_DAYS = 90;
/** Without an offset, which may change within a period. */
const ZONE = Intl.DateTimeFormat().resolvedOptions().timeZone;
/** The service answers with so many at most. */
const MOST = 1000;

/** The day in local time, as a date field wants it. */
function day(at: Date): string {
  return new Date(at.getTime() - at.getTimezoneOffset() * 60_000).toISOString().slice(0, 10);
}

function midnight(written: string): Date {
  return new Date(`${written}T00:00`);
}

/** Midnight so many days later: days are not all of 24 hours. */
function daysLater(at: Date, days: number): Date {
  return new Date(at.getFullYear(), at.getMonth(), at.getDate() + days);
}

/** Whether it is a day of the calendar, as a date field writes it. */
function isDay(written: string): boolean {
  const at = midnight(written);
  return !Number.isNaN(at.getTime()) && day(at) === written;
}

/** Why there is no report of a period; empty where there is one. */
function wrongWith(first: string, last: string): string[] {
  const ends = [["first", "from", first], ["last", "to", last]] as const;
  const none = ends.filter(([, , written]) => !isDay(written));
  if (none.length === 0 && first > last) return ["The period's first day lies behind its last."];
  return none.map(([which, name, written]) => `The period's ${which} day is no date: “${written}”. Choose one, or write ${name}=2026-01-31 in the address, without a time.`);
}

export function Report({ id }: { id: string }) {
  useLayoutEffect(() => {
    onPaper(true);
    return () => onPaper(false);
  }, []);
  const answer = useResource<MachineRevision>(`/machines/${id}`);
  return (
    <Shown answer={answer} lines={20}>
      {({ document, revision }) => <Whole machine={document} revision={revision} />}
    </Shown>
  );
}

function Whole({ machine, revision }: { machine: Document; revision: number }) {
  const { query: chosen } = useStore(place);
  const first = chosen.get("from") ?? day(daysLater(new Date(), -PERIOD_DAYS));
  const last = chosen.get("to") ?? day(new Date());
  const wrong = wrongWith(first, last);
  if (wrong.length > 0) return <Panel title="Report"><Period first={first} last={last} />{wrong.map((one) => <Empty key={one}>{one}</Empty>)}</Panel>;
  const from = midnight(first);
  const to = new Date(daysLater(midnight(last), 1).getTime() - 1);
  return (
    <article class="report">
      <header>
        <p class="buttons screen">
          <a href={link(["machines", machine.id])}>Back to the machine</a>
        </p>
        <h1>{machine.name}</h1>
        <p>
          {machine.plant} / {machine.id}, document revision {revision}. {from.toLocaleDateString()} to {to.toLocaleDateString()}. Made{" "}
          {new Date().toLocaleString()}. Times are local time of {ZONE}.
        </p>
        <Period first={first} last={last} />
      </header>
      <Body machine={machine} from={from.toISOString()} to={to.toISOString()} />
    </article>
  );
}

function Period({ first, last }: { first: string; last: string }) {
  return (
    <div class="choices">
      <label>
        From
        <input type="date" value={first} onChange={(event) => choose({ from: event.currentTarget.value })} />
      </label>
      <label>
        To
        <input type="date" value={last} onChange={(event) => choose({ to: event.currentTarget.value })} />
      </label>
      <button type="button" class="strong" onClick={() => window.print()}>
        Print, or save as PDF
      </button>
    </div>
  );
}

function Body({ machine, from, to }: { machine: Document; from: string; to: string }) {
  const alerts = useResource<Alert[]>(`/machines/${machine.id}/alerts?limit=${MOST}`);
  const runs = useResource<Run[]>(`/machines/${machine.id}/runs${query({ from, to, limit: MOST })}`);
  const timeline = useResource<TimelineEntry[]>(`/machines/${machine.id}/timeline${query({ from, to, limit: MOST })}`);
  const identified = useResource<IdentificationSummary[]>(`/machines/${machine.id}/identifications${query({ from, to, limit: MOST })}`);
  const found = useNewestOf(identified.data);
  const newest = found.data;
  const refused = found.failure ?? identified.failure;
  const then = useAlertsAt(alerts.data, to);
  const during = (then.data ?? []).filter((one) => one.opened_at <= to && (one.closed_at ?? to) >= from);
  const cut = [alerts, runs, timeline, identified].some((one) => one.data?.length === MOST);
  const awaited = !newest && identified.data?.length !== 0;
  const elements = newest ? reported(elementsOf(newest.estimates), during) : [];
  return (
    <>
      <Panel title="In short">
        <Summary runs={runs.data} identified={identified.data} alerts={then.data && during} to={to} />
        {cut && <p class="muted">Of each kind the newest {MOST} are counted and shown; there may be more.</p>}
        {identified.data?.length === 0 && <p class="muted">Nothing was identified in this period.</p>}
        <MarkedTrain machine={machine} newest={newest} open={during.filter((one) => openAt(one, to))} />
      </Panel>
      <Panel title="Alerts of the period">
        <Shown answer={{ data: then.data, failure: alerts.failure ?? then.failure, asOf: alerts.asOf ?? then.asOf }}>{() => <AlertTable alerts={during} />}</Shown>
      </Panel>
      <Panel title="What was done">
        <Shown answer={timeline}>
          {(entries) =>
            entries.length === 0 ? (
              <Empty>Nothing is on the machine's timeline.</Empty>
            ) : (
              <ul>
                {entries.map((one) => (
                  <li key={one.id}>
                    <Time at={one.at} /> {one.kind}, {one.by}: {one.text}
                  </li>
                ))}
              </ul>
            )
          }
        </Shown>
      </Panel>
      {newest &&
        elements.map((element) => (
          <Histories
            key={element}
            machine={machine.id}
            rotation={machine.rotation}
            element={element}
            names={newest.estimates.filter((one) => one.element === element).map((one) => one.parameter)}
            newest={newest}
            from={from}
            to={to}
            scope="run"
            alerts={then.data ?? []}
            height={190}
          />
        ))}
      {awaited && <Awaited title="What was identified" failure={refused} />}
      {newest && <Identified machine={machine} found={newest} />}
    </>
  );
}

/** The train as it was at the end of the period. */
function MarkedTrain({ machine, newest, open }: { machine: Document; newest: Identification | undefined; open: Alert[] }) {
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  const changes = useResource<Deviations>(comparable(newest) ? `/machines/${machine.id}/deviations?identification=${newest.id}` : null);
  const awaited = comparable(newest) && !changes.data && !changes.failure?.own;
  return (
    <Shown answer={awaited ? { data: undefined, failure: drawing.failure } : drawing} lines={15}>
      {(found) => (
        <>
          <Legend />
          <Train name={machine.name} drawing={found} marks={marksOf(open, changes.data)} chosen={null} onChoose={() => undefined} />
          {!changes.data && changes.failure && <Trouble failure={changes.failure} />}
          <Marked changes={changes.data} />
        </>
      )}
    </Shown>
  );
}

function Marked({ changes }: { changes: Deviations | undefined }) {
  return (
    <p class="muted">
      {changes && !changes.missing && (
        <>
          Changes are those of identification {changes.identification} (<Time at={changes.measured_at} />) against its baseline.{" "}
        </>
      )}
      {changes?.missing && `No changes are marked: ${changes.missing}. `}
      Alerts are those open at the end of the period.
    </p>
  );
}

/** Elements whose trends are shown: couplings, and whatever had an alert. */
function reported(elements: string[], alerts: Alert[]): string[] {
  return elements.filter((one) => one.startsWith("coupling.") || alerts.some((alert) => alert.element === one));
}

function Summary(props: { runs: Run[] | undefined; identified: IdentificationSummary[] | undefined; alerts: Alert[] | undefined; to: string }) {
  const { runs, identified, alerts, to } = props;
  const accepted = identified?.filter((one) => one.accepted).length;
  const speeds = (runs ?? []).map((one) => one.speed_maximum_rpm ?? 0);
  return (
    <p>
      {counted(runs?.length, "run")}
      {speeds.length > 0 && `, up to ${rpm(Math.max(...speeds))}`}; {counted(identified?.length, "identification")}, of which {accepted ?? "…"}{" "}
      accepted; {counted(alerts?.length, "alert")}, of which {alerts?.filter((one) => openAt(one, to)).length ?? "…"} open
      at the end of the period.
    </p>
  );
}

function counted(count: number | undefined, what: string): string {
  return `${count ?? "…"} ${what}${count === 1 ? "" : "s"}`;
}

function AlertTable({ alerts }: { alerts: Alert[] }) {
  if (alerts.length === 0) return <Empty>No alert in this period.</Empty>;
  return (
    <div class="scroll">
      <table>
        <thead>
          <tr>
            <th title="at the end of the period">Severity</th>
            <th>Element</th>
            <th title="at the end of the period">State</th>
            <th>Opened</th>
            <th>Closed</th>
            <th title="at the end of the period">What it said</th>
          </tr>
        </thead>
        <tbody>
          {alerts.map((one) => (
            <tr key={one.id}>
              <td>
                <Severity severity={one.severity} />
              </td>
              <td>{elementName(one.element)}</td>
              <td>{stateInWords(one.state)}</td>
              <td>
                <Time at={one.opened_at} />
              </td>
              <td>
                <Time at={one.closed_at} />
              </td>
              <td>{one.message}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
