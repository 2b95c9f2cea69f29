// Histories of an element's parameters, with their intervals, what they are compared with, and what was done to the machine.
import { useEffect } from "preact/hooks";
import type { Alert, BaselineBand, Document, IdentificationSummary, Sense, Series, TimelineEntry, Trends, TrendTest, TrendTests } from "../schemas/answers";
import { PREFIX, query } from "../data/http-client";
import { angleSense, elementName, isCrossCoupled, isUnbalance, number, percent, scaleOf, termName, when } from "../words/format";
import { Cut, Panel, Severity, SEVERITY_GLYPHS, Shown, Time } from "../components/parts";
import { MARKS, Names, Plot, type Curve, type Marker } from "../plots/plot";
import { Awaited, Behind, comparable, elementsOf, NotIdentified, useNewest } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { choose, go, place } from "../browser/router";
import { useStore } from "../browser/store";
import { findings } from "../words/trend-tests";
import { AngleHistory, angleWords } from "../panels/angle-history";

const RANGES: [string, string, number][] = [
  ["month", "1 month", 31],
  ["quarter", "3 months", 92],
  ["year", "1 year", 366],
  ["all", "all", Infinity],
];
const MS = 30_000;
const DAY_MS = 86_400_000;
/** The service answers with so many entries of the timeline at most. */
const MOST_MARKS = 1000;
const MOST_POINTS = 2000;
/** So many alerts are marked in the trends at most. */
const MOST_ALERTS = 200;
/** What is taken away as a file is not thinned out before the service must. */
const MOST_IN_FILE = 20_000;
/** Stands for an element in the choice: what follows from the parameters. */
const DERIVED = "derived quantities";

export function TrendsView({ machine }: { machine: Document }) {
  const { query: chosen } = useStore(place);
  const { newest, none, failure, listed } = useNewest(machine.id);
  const told = useResource<Alert[]>(`/machines/${machine.id}/alerts?limit=${MOST_ALERTS}`, 30_000);
  const alerts = told.data ?? [];
  const elements = newest ? [...elementsOf(newest.estimates), ...(newest.derived.length > 0 ? [DERIVED] : [])] : [];
  const open = alerts.find((one) => !one.closed_at)?.element;
  const element = [chosen.get("element"), open, machine.couplings[0] && `coupling.${machine.couplings[0].id}`, elements[0]].find(
    (one) => one && elements.includes(one),
  );
  const known = told.data || told.failure ? element : undefined;
  useEffect(() => {
    // A later alert does not change what somebody looks at.
    if (known && !chosen.get("element")) choose({ element: known });
  }, [known, chosen]);
  if (none) return <NotIdentified />;
  if (!newest || !element) return <Awaited title="Trends" failure={failure} />;
  const range = chosen.get("range") ?? "all";
  const days = RANGES.find(([id]) => id === range)?.[2] ?? Infinity;
  const names = element === DERIVED ? newest.derived.map((one) => one.name) : newest.estimates.filter((one) => one.element === element).map((one) => one.parameter);
  return (
    <>
      <Behind failure={failure} listed={listed} />
      <Panel title="What is shown">
        <div class="choices">
          <Elements elements={elements} chosen={element} alerts={alerts} />
          <span class="buttons" role="group" aria-label="Time range">
            {RANGES.map(([id, words]) => (
              <button key={id} type="button" aria-pressed={id === range} onClick={() => choose({ range: id })}>
                {words}
              </button>
            ))}
          </span>
          <label class="switch">
            <input
              type="checkbox"
              checked={chosen.get("scope") === "gathered"}
              onChange={(event) => choose({ scope: event.currentTarget.checked ? "gathered" : null })}
            />
            of the newest runs together
          </label>
        </div>
        <Cut shown={alerts.length} most={MOST_ALERTS} of="alerts of the machine" />
      </Panel>
      <Histories
        key={[element, range, chosen.get("scope")].join()}
        machine={machine.id}
        rotation={machine.rotation}
        element={element}
        names={names}
        newest={newest}
        shownDays={days}
        scope={chosen.get("scope") ?? "run"}
        alerts={alerts}
      />
    </>
  );
}

function Elements({ elements, chosen, alerts }: { elements: string[]; chosen: string; alerts: Alert[] }) {
  const open = alerts.filter((one) => !one.closed_at);
  return (
    <span class="buttons" role="group" aria-label="Element">
      {elements.map((one) => (
        <button key={one} type="button" aria-pressed={one === chosen} onClick={() => choose({ element: one })}>
          <Worst alerts={open.filter((alert) => alert.element === one)} />
          {elementName(one)}
        </button>
      ))}
    </span>
  );
}

function Worst({ alerts }: { alerts: Alert[] }) {
  const severity = Object.keys(SEVERITY_GLYPHS).find((one) => alerts.some((alert) => alert.severity === one));
  return severity ? <><Severity severity={severity} word={false} /> </> : null;
}

interface HistoriesProps {
  machine: string;
  rotation: Sense | undefined;
  element: string;
  names: string[];
  /** The identification that speaks for the machine, within the period if there is one. */
  newest: IdentificationSummary;
  from?: string | null;
  /** The end of a period that may be past: nothing is said that was not known then. */
  to?: string | null;
  /** Only the newest days are shown, of all that is asked for. */
  shownDays?: number;
  scope: string;
  alerts: Alert[];
  height?: number;
}

export function Histories(props: HistoriesProps) {
  const { machine, element, names, newest, from = null, to = null, shownDays = Infinity, scope, alerts } = props;
  const wanted = { parameter: names, from, to, scope };
  const asked = query({ ...wanted, max_points: MOST_POINTS });
  const answer = useResource<Trends>(`/machines/${machine}/trends${asked}`, MS);
  const judged = scope === "run" && element !== DERIVED && comparable(newest);
  // Without an identification the tests are up to the newest of all.
  const identification = to === null ? null : newest.id;
  const judgement = useResource<TrendTests>(judged ? `/machines/${machine}/trend-tests${query({ parameter: names, identification })}` : null, to === null ? MS : 0);
  const tests = judgement.data;
  // Words that come later than the plots would move them.
  const awaited = judged && !tests && !judgement.failure;
  const xRange = windowOf(answer.data?.series ?? [], shownDays);
  const timeline = useResource<TimelineEntry[]>(`/machines/${machine}/timeline${query({ from, to, limit: MOST_MARKS })}`, 60_000).data ?? [];
  const markers = markersOf(alerts.filter((one) => one.element === element), timeline).filter((one) => within(one, from, to));
  return (
    <Panel
      title={`${elementName(element)}: ${scope === "run" ? "of single runs" : "of the newest runs together"}, bands are 95 % intervals`}
      aside={
        <a class="screen" href={`${PREFIX}/machines/${machine}/trends${query({ ...wanted, max_points: MOST_IN_FILE, format: "csv" })}`} download={`${machine}-${element}.csv`}>
          CSV
        </a>
      }
    >
      <Shown answer={awaited ? { data: undefined, failure: answer.failure } : answer} lines={30}>
        {({ series }) => (
          <>
            <p class="muted">
              <Names curves={kindsOf(series).map((name) => ({ name }))} />
              {series.some((one) => one.baselines.length > 0) && " · Grey: where 95 % of the estimates lie while the machine is as at its baseline; per cent are against its middle."}
              {names.some(isUnbalance) && ` · Angles of unbalances: ${angleSense(props.rotation)}.`}
            </p>
            <div class="plots">
              {series.map((one) => (
                <History
                  key={one.parameter}
                  name={element === DERIVED ? one.parameter : termName(one.parameter)}
                  series={one}
                  kinds={kindsOf(series)}
                  markers={markers}
                  tests={judged ? (tests?.tests ?? []).filter((test) => test.name === one.parameter || test.name.startsWith(`${one.parameter}.`)) : null}
                  xRange={xRange}
                  height={props.height ?? 190}
                />
              ))}
            </div>
            <Marks markers={markers} />
            {to === null && <Cut shown={timeline.length} most={MOST_MARKS} of="entries of the timeline" />}
          </>
        )}
      </Shown>
    </Panel>
  );
}

function markersOf(alerts: Alert[], timeline: TimelineEntry[]): Marker[] {
  const raised = alerts.map<Marker>((one) => ({
    // At the run that raised it: it was opened when that was computed, which may be much later.
    x: Date.parse(one.first_measured_at) / 1000,
    kind: one.severity === "danger" ? "danger" : "alert",
    words: `${one.message} (first measured ${when(one.first_measured_at)}, last ${when(one.measured_at)}, opened ${when(one.opened_at)})`,
  }));
  const entered = timeline.map<Marker>((one) => ({
    x: Date.parse(one.at) / 1000,
    kind: one.kind === "maintenance" ? "maintenance" : "note",
    words: `${one.kind}: ${one.text}`,
  }));
  return [...raised, ...entered];
}

function within({ x }: Marker, from: string | null, to: string | null): boolean {
  return (from === null || x >= Date.parse(from) / 1000) && (to === null || x <= Date.parse(to) / 1000);
}

function kindsOf(series: Series[]): string[] {
  return [...new Set(series.flatMap((one) => one.run_kind))].sort();
}

function Marks({ markers }: { markers: Marker[] }) {
  return (
    <ul class="marks muted">
      {markers.map((one) => (
        <li>
          {MARKS[one.kind]} <Time at={new Date(one.x * 1000).toISOString()} /> {one.words}
        </li>
      ))}
    </ul>
  );
}

/** The newest days; undefined: all. */
function windowOf(series: Series[], days: number): [number, number] | undefined {
  const newest = Math.max(0, ...series.map((one) => Date.parse(one.measured_at.at(-1) ?? "") / 1000 || 0));
  return Number.isFinite(days) && newest > 0 ? [newest - (days * DAY_MS) / 1000, newest + (0.02 * days * DAY_MS) / 1000] : undefined;
}

/** The baseline that a point is compared with. */
function baselineAt(series: Series, index: number): BaselineBand | undefined {
  const at = series.measured_at[index]!;
  return series.baselines.find((one) => one.run_kind === series.run_kind[index] && one.since <= at && (one.until === null || at < one.until));
}

interface HistoryProps {
  name: string;
  series: Series;
  kinds: string[];
  markers: Marker[];
  /** Null where nothing is tested. */
  tests: TrendTest[] | null;
  xRange: [number, number] | undefined;
  height: number;
}

function History({ name, series, kinds, markers, tests, xRange, height }: HistoryProps) {
  const unit = series.unit;
  const sizes = series.value.filter((one) => one !== null).map(Math.abs);
  const scale = scaleOf(Math.max(0, ...sizes), unit);
  const scaled = (one: number | null | undefined) => (one === null || one === undefined ? null : one * scale.factor);
  const accepted = (index: number) => series.quality[index] === "accepted";
  const only = (values: (number | null)[], keep: (index: number) => boolean) => values.map((one, index) => (keep(index) ? scaled(one) : null));
  const curves: Curve[] = kinds.map((kind, index) => {
    const keep = (at: number) => series.run_kind[at] === kind && accepted(at);
    return { name: kind, style: index, y: only(series.value, keep), lower: only(series.lower, keep), upper: only(series.upper, keep), points: true, spans: true };
  });
  if (series.quality.some((one) => one === "not_accepted")) {
    curves.push({ name: "not accepted", y: only(series.value, (at) => series.quality[at] === "not_accepted"), faint: true, points: true, line: false });
  }
  const bands = series.baselines.map((one) => ({
    low: one.lower * scale.factor,
    high: one.upper * scale.factor,
    from: Date.parse(one.since) / 1000,
    to: one.until === null ? null : Date.parse(one.until) / 1000,
  }));
  const readOut = (index: number) => {
    const value = series.value[index];
    const at = `${when(series.measured_at[index]!)} ${series.run_kind[index]}`;
    if (value === null || value === undefined) return `${at}: not estimable`;
    const low = scaled(series.lower[index]);
    const high = scaled(series.upper[index]);
    const base = baselineAt(series, index);
    const beside = base && !isCrossCoupled(series.parameter) ? `, ${percent(value / base.centre - 1)}` : "";
    const doubt = accepted(index) ? "" : ", not accepted";
    const turned = angleWords(series.angle_deg?.[index] ?? null, series.angle_half_width_deg?.[index] ?? null);
    return `${at}: ${number(scaled(value), 4)} (${number(low)} … ${number(high)}) ${scale.unit}${turned}${beside}${doubt}`;
  };
  const onPick = (index: number) => {
    const parts = place.value.parts;
    if (parts[1]) go(["machines", parts[1], "identified"], { identification: String(series.identification[index]) });
  };
  const thinned = series.down_sampling && series.down_sampling.method !== "none";
  return (
    <figure class="history-plot">
      <figcaption>
        <strong>{name}</strong> [{scale.unit || "-"}]
        {thinned && <span class="muted"> lowest and highest of each stretch, of {series.down_sampling!.points} points</span>}
      </figcaption>
      {tests && <p class="told">{findings(series.parameter, tests).join("; ")}</p>}
      <Plot
        label={`${series.parameter} over time, ${series.value.length} points`}
        x={series.measured_at.map((one) => Date.parse(one) / 1000)}
        time
        yUnit={scale.unit}
        curves={curves}
        markers={markers}
        bands={bands}
        {...(xRange ? { xRange } : {})}
        together="trends"
        height={height}
        readOut={readOut}
        onPick={onPick}
      />
      {series.real && <AngleHistory series={series} kinds={kinds} markers={markers} xRange={xRange} readOut={readOut} onPick={onPick} />}
    </figure>
  );
}
