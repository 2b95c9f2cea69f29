// The histories of an element's parameters, with alerts and maintenance marked in them.
import { Loaded } from "../components/loading";
import { Panel, Truncated } from "../components/panel";
import { Time } from "../components/time";
import { queryString } from "../data/http-client";
import { isComparable } from "../data/newest-identification";
import { useOtherTrends, type OtherTrends } from "../data/other-trends";
import { useResource } from "../data/resource";
import { angleConvention } from "../format/angles";
import { elementName, isUnbalance, parameterName, quantityName } from "../format/names";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import { CurveLegend } from "../plots/curve-legend";
import { MARKER_SIGNS } from "../plots/curve-style";
import type { Marker } from "../plots/plot-props";
import type { Alert } from "../schemas/alerts";
import type { IdentificationSummary } from "../schemas/identifications";
import type { Sense, TimelineEntry } from "../schemas/machines";
import type { Series, Trends, TrendTest, TrendTests } from "../schemas/trends";
import { HistoryFile } from "./history-file";
import { curveName, type MachineHistory } from "./history-points";
import { ParameterHistory } from "./parameter-history";

const POLL_MS = 30_000;
const DAY_MS = 86_400_000;
/** The API's limit for a page of the timeline. */
const MAX_TIMELINE = 1000;
const MAX_POINTS = 2000;
/** A downloaded file is not thinned out before the API's limit. */
const MAX_FILE_POINTS = 20_000;
/** Stands for an element: the quantities derived from the parameters. */
export const DERIVED = "derived_quantities";

interface Props {
  machine: string;
  rotation: Sense | undefined;
  element: string;
  names: string[];
  /** The newest identification, within the period if there is one. */
  newest: IdentificationSummary;
  from?: string | null;
  /** The end of a period that may be past: the results of trend tests are those of that time. */
  to?: string | null;
  /** A stretch that is shown alone; tests and baselines are still those of all. */
  shown?: { from: string | null; to: string | null };
  /** Only the newest days are shown, of all that is loaded. */
  shownDays?: number;
  scope: string;
  alerts: Alert[];
  height?: number;
  /** Another machine, whose histories of the same parameters are in the same plots. */
  beside?: string | undefined;
}

export function ElementHistories(props: Props) {
  const { machine, element, names, from = null, to = null, scope, alerts, beside } = props;
  const query = { parameter: names, from, to, scope };
  const other = useOtherTrends(beside, { ...query, max_points: MAX_POINTS });
  const result = useResource<Trends>(`/machines/${machine}/trends${queryString({ ...query, max_points: MAX_POINTS })}`, POLL_MS);
  const { tests, isPending } = useTrendTests(props);
  const timeline = useResource<TimelineEntry[]>(`/machines/${machine}/timeline${queryString({ from, to, limit: MAX_TIMELINE })}`, 60_000).data ?? [];
  const markers = markersOf(alerts.filter((one) => one.element === element), timeline).filter((one) => isWithin(one, from, to));
  const files = [machine, ...(other.names.length > 0 ? [beside!] : [])].map((one) => ({
    machine: one,
    path: `/machines/${one}/trends${queryString({ ...query, parameter: one === machine ? names : other.names, max_points: MAX_FILE_POINTS, format: "csv" })}`,
  }));
  return (
    <Panel
      title={t("historiesTitle", { element: elementName(element), scope: scope === "run" ? t("singleRuns") : t("pooledRuns") })}
      aside={<HistoryFile files={files} element={element} />}
    >
      {/* Results of tests that came later than the plots would move these. */}
      <Loaded result={isPending || other.isPending ? { data: undefined, failure: result.failure } : result} lines={30}>
        {({ series }) => (
          <>
            <Explanation {...props} series={series} beside={beside && { ...other, machine: beside }} />
            <Plots {...props} series={series} other={other.series} markers={markers} tests={tests} />
            <MarkerList markers={markers} />
            {to === null && <Truncated shown={timeline.length} limit={MAX_TIMELINE} of={t("entriesOfTheTimeline")} />}
          </>
        )}
      </Loaded>
    </Panel>
  );
}

/** The trend tests up to the newest identification; null where nothing is tested. */
function useTrendTests({ machine, element, names, newest, to = null, scope }: Props): { tests: TrendTest[] | null; isPending: boolean } {
  const isTested = scope === "run" && element !== DERIVED && isComparable(newest);
  // Without an identification the tests are up to the newest of all.
  const identification = to === null ? null : newest.id;
  const path = `/machines/${machine}/trend-tests${queryString({ parameter: names, identification })}`;
  const { data, failure } = useResource<TrendTests>(isTested ? path : null, to === null ? POLL_MS : 0);
  return { tests: isTested ? (data?.tests ?? []) : null, isPending: isTested && !data && !failure };
}

interface ShownHistoriesProps extends Props {
  series: Series[];
  other: Series[];
}

interface Explained {
  machine: string;
  names: string[];
  rotation: Sense | undefined;
  series: Series[];
  beside: (OtherTrends & { machine: string }) | undefined | "";
}

function Explanation({ machine, names, rotation, series, beside }: Explained) {
  const kinds = kindsOf([...series, ...(beside ? beside.series : [])]);
  const machines = beside ? [machine, beside.machine] : [machine];
  return (
    <p class="muted">
      <CurveLegend curves={machines.flatMap((one) => kinds.map((kind) => ({ name: curveName({ machine: one, named: !!beside }, kind) })))} />
      {series.some((one) => one.baselines.length > 0) && t("greyBandExplained")}
      {names.some(isUnbalance) && anglesCounted(machine, rotation, beside)}
      {beside && besideExplained(beside)}
    </p>
  );
}

/** How angles count, of each machine by itself where the two do not turn the same way. */
function anglesCounted(machine: string, rotation: Sense = "positive", beside: Explained["beside"]): string {
  const own = { machine, convention: angleConvention(rotation) };
  if (!beside || beside.series.length === 0 || beside.rotation === rotation) return t("anglesCounted", own);
  const other = beside.rotation && t("anglesCountedOf", { machine: beside.machine, convention: angleConvention(beside.rotation) });
  return t("anglesCountedOf", own) + (other ?? "");
}

function besideExplained({ machine, series, failure }: Exclude<Explained["beside"], undefined | "">) {
  if (series.length > 0) return t("besideExplained", { machine });
  if (failure) return <span class="error"> {t("historyOfNotLoaded", { machine, failure: failure.message })}</span>;
  return ` ${t("noHistoryOf", { machine })}`;
}

function Plots(props: ShownHistoriesProps & { markers: Marker[]; tests: TrendTest[] | null }) {
  const { series, other, element, tests, machine, beside } = props;
  const all = [...series, ...other];
  const xRange = chosenStretch(all, props.shown) ?? newestDays(all, props.shownDays ?? Infinity);
  const otherOf = (name: string): MachineHistory | undefined => {
    const found = other.find((one) => one.parameter === name);
    return found && { series: found, machine: beside!, named: true };
  };
  return (
    <div class="plots">
      {series.map((one) => (
        <ParameterHistory
          key={one.parameter}
          name={element === DERIVED ? parameterName(one.parameter) : quantityName(one.parameter)}
          history={{ series: one, machine, named: !!beside }}
          beside={otherOf(one.parameter)}
          kinds={kindsOf(all)}
          markers={props.markers}
          tests={tests && tests.filter((test) => test.name === one.parameter || test.name.startsWith(`${one.parameter}.`))}
          xRange={xRange}
          height={props.height ?? 190}
        />
      ))}
    </div>
  );
}

function markersOf(alerts: Alert[], timeline: TimelineEntry[]): Marker[] {
  const raised = alerts.map<Marker>((one) => ({
    // At the run that raised it: it was opened when that was computed, which may be much later.
    x: Date.parse(one.first_measured_at) / 1000,
    kind: one.severity === "danger" ? "danger" : "alert",
    words: t("alertMarker", { message: one.message, first: when(one.first_measured_at), last: when(one.measured_at), opened: when(one.opened_at) }),
  }));
  const entered = timeline.map<Marker>((one) => ({
    x: Date.parse(one.at) / 1000,
    kind: one.kind === "maintenance" ? "maintenance" : "note",
    words: `${term(one.kind)}: ${one.text}`,
  }));
  return [...raised, ...entered];
}

function isWithin({ x }: Marker, from: string | null, to: string | null): boolean {
  return (from === null || x >= Date.parse(from) / 1000) && (to === null || x <= Date.parse(to) / 1000);
}

function kindsOf(series: Series[]): string[] {
  return [...new Set(series.flatMap((one) => one.run_kind))].sort();
}

function MarkerList({ markers }: { markers: Marker[] }) {
  return (
    <ul class="timeline muted">
      {markers.map((one) => (
        <li>
          {MARKER_SIGNS[one.kind]} <Time at={new Date(one.x * 1000).toISOString()} /> {one.words}
        </li>
      ))}
    </ul>
  );
}

/** The range that a person has chosen, open ends at the data's; undefined where nothing was chosen. */
function chosenStretch(series: Series[], shown: Props["shown"]): [number, number] | undefined {
  if (!shown || (shown.from === null && shown.to === null)) return undefined;
  const times = series.flatMap((one) => [one.measured_at[0], one.measured_at.at(-1)]).flatMap((one) => (one ? [Date.parse(one) / 1000] : []));
  const [low, high] = [Math.min(...times), Math.max(...times)];
  const from = shown.from === null ? low : Date.parse(shown.from) / 1000;
  const to = shown.to === null ? high : Date.parse(shown.to) / 1000;
  return from < to ? [from, to] : undefined;
}

/** The range of the newest days; undefined: all. */
function newestDays(series: Series[], days: number): [number, number] | undefined {
  const newest = Math.max(0, ...series.map((one) => Date.parse(one.measured_at.at(-1) ?? "") / 1000 || 0));
  return Number.isFinite(days) && newest > 0 ? [newest - (days * DAY_MS) / 1000, newest + (0.02 * days * DAY_MS) / 1000] : undefined;
}
