// Histories of an element's parameters, with their intervals, what they are compared with, and what was done to the machine.
import type { Alert, Document, Estimate, Identification, IdentificationSummary, Series, TimelineEntry, Trends } from "./answers";
import { PREFIX, query } from "./api";
import { elementName, number, percent, scaleOf, termName, when } from "./format";
import { Empty, Panel, Shown, Time } from "./parts";
import { MARKS, Names, Plot, type Curve, type Marker } from "./plot";
import { useResource } from "./resource";
import { choose, go, place } from "./router";
import { useStore } from "./store";

const RANGES: [string, string, number][] = [
  ["month", "1 month", 31],
  ["quarter", "3 months", 92],
  ["year", "1 year", 366],
  ["all", "all", Infinity],
];
const DAY_MS = 86_400_000;
const MOST_POINTS = 2000;

/** The newest accepted identification, or the newest of all. */
export function useNewest(machine: string): { newest: Identification | undefined; none: boolean; failure: string | undefined } {
  const list = useResource<IdentificationSummary[]>(`/machines/${machine}/identifications?limit=20`, 15_000);
  const chosen = list.data?.find((one) => one.accepted && one.scope === "run") ?? list.data?.[0];
  const answer = useResource<Identification>(chosen ? `/identifications/${chosen.id}` : null);
  return { newest: answer.data, none: list.data?.length === 0, failure: (list.failure ?? answer.failure)?.message };
}

export function NotIdentified() {
  return (
    <Panel title="Nothing to show yet">
      <Empty>No run of this machine was identified yet. The first one that covers enough of the speed range will be.</Empty>
    </Panel>
  );
}

export function elementsOf(estimates: Estimate[]): string[] {
  return [...new Set(estimates.map((one) => one.element))];
}

export function TrendsView({ machine }: { machine: Document }) {
  const { query: chosen } = useStore(place);
  const { newest, none, failure } = useNewest(machine.id);
  const alerts = useResource<Alert[]>(`/machines/${machine.id}/alerts?limit=200`, 30_000).data ?? [];
  if (none) return <NotIdentified />;
  if (!newest) return <Panel title="Trends">{failure ?? <div class="waiting" style={{ minHeight: "420px" }} />}</Panel>;
  const elements = elementsOf(newest.estimates);
  const open = alerts.find((one) => !one.closed_at)?.element;
  const element = [chosen.get("element"), open, machine.couplings[0] && `coupling.${machine.couplings[0].id}`, elements[0]].find(
    (one) => one && elements.includes(one),
  )!;
  const range = chosen.get("range") ?? "all";
  const days = RANGES.find(([id]) => id === range)?.[2] ?? Infinity;
  const from = Number.isFinite(days) ? new Date(Math.floor((Date.now() - days * DAY_MS) / 3_600_000) * 3_600_000).toISOString() : null;
  return (
    <>
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
      </Panel>
      <Histories
        machine={machine.id}
        element={element}
        names={newest.estimates.filter((one) => one.element === element).map((one) => one.parameter)}
        from={from}
        scope={chosen.get("scope") ?? "run"}
        alerts={alerts}
      />
    </>
  );
}

function Elements({ elements, chosen, alerts }: { elements: string[]; chosen: string; alerts: Alert[] }) {
  const open = new Set(alerts.filter((one) => !one.closed_at).map((one) => one.element));
  return (
    <span class="buttons" role="group" aria-label="Element">
      {elements.map((one) => (
        <button key={one} type="button" aria-pressed={one === chosen} onClick={() => choose({ element: one })}>
          {open.has(one) && <span class="severity alert">▲ </span>}
          {elementName(one)}
        </button>
      ))}
    </span>
  );
}

interface HistoriesProps {
  machine: string;
  element: string;
  names: string[];
  from: string | null;
  to?: string | null;
  scope: string;
  alerts: Alert[];
  height?: number;
}

export function Histories(props: HistoriesProps) {
  const { machine, element, names, from, to = null, scope, alerts } = props;
  const asked = query({ parameter: names, from, to, scope, max_points: MOST_POINTS });
  const answer = useResource<Trends>(`/machines/${machine}/trends${asked}`, 30_000);
  const timeline = useResource<TimelineEntry[]>(`/machines/${machine}/timeline?limit=200`, 60_000).data ?? [];
  const markers = markersOf(alerts.filter((one) => one.element === element), timeline);
  return (
    <Panel
      title={`${elementName(element)}: ${scope === "run" ? "of single runs" : "of the newest runs together"}, bands are 95 % intervals`}
      aside={
        <a class="screen" href={`${PREFIX}/machines/${machine}/trends${asked}&format=csv`} download={`${machine}-${element}.csv`}>
          CSV
        </a>
      }
    >
      <Shown answer={answer} lines={30}>
        {({ series }) => (
          <>
            <Names curves={kindsOf(series).map((name) => ({ name }))} />
            <div class="plots">
              {series.map((one) => (
                <History key={one.parameter} series={one} kinds={kindsOf(series)} markers={markers} height={props.height ?? 190} />
              ))}
            </div>
            <Marks markers={markers} />
          </>
        )}
      </Shown>
    </Panel>
  );
}

function markersOf(alerts: Alert[], timeline: TimelineEntry[]): Marker[] {
  const raised = alerts.map<Marker>((one) => ({
    x: Date.parse(one.opened_at) / 1000,
    kind: one.severity === "danger" ? "danger" : "alert",
    words: one.message,
  }));
  const entered = timeline.map<Marker>((one) => ({
    x: Date.parse(one.at) / 1000,
    kind: one.kind === "maintenance" ? "maintenance" : "note",
    words: `${one.kind}: ${one.text}`,
  }));
  return [...raised, ...entered];
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

function History({ series, kinds, markers, height }: { series: Series; kinds: string[]; markers: Marker[]; height: number }) {
  const unit = series.unit ?? "";
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
  const base = series.baseline ?? null;
  const readOut = (index: number) => {
    const value = series.value[index];
    const at = `${when(series.measured_at[index]!)} ${series.run_kind[index]}`;
    if (value === null || value === undefined) return `${at}: not estimable`;
    const low = scaled(series.lower[index]);
    const high = scaled(series.upper[index]);
    const beside = base ? `, ${percent(value / base.centre - 1)} to the baseline` : "";
    const doubt = accepted(index) ? "" : ", not accepted";
    return `${at}: ${number(scaled(value), 4)} (${number(low)} … ${number(high)}) ${scale.unit}${beside}${doubt}`;
  };
  const thinned = series.down_sampling && series.down_sampling.method !== "none";
  return (
    <figure class="history-plot">
      <figcaption>
        <strong>{termName(series.parameter)}</strong> [{scale.unit || "-"}]
        {thinned && <span class="muted"> lowest and highest of each stretch, of {series.down_sampling!.points} points</span>}
      </figcaption>
      <Plot
        label={`${series.parameter} over time, ${series.value.length} points`}
        x={series.measured_at.map((one) => Date.parse(one) / 1000)}
        time
        yUnit={scale.unit}
        curves={curves}
        markers={markers}
        band={base && { low: base.lower * scale.factor, high: base.upper * scale.factor, words: "baseline" }}
        together="trends"
        height={height}
        readOut={readOut}
        onPick={(index) => {
          const parts = place.value.parts;
          if (parts[1]) go(["machines", parts[1], "identified"], { identification: String(series.identification[index]) });
        }}
      />
    </figure>
  );
}
