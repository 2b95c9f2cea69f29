// The trends of a machine: the histories of one element at a time.
import { useEffect } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { NewestNotice, NoIdentification, PendingPanel } from "../components/newest-identification";
import { Panel, Truncated } from "../components/panel";
import { PeriodFields } from "../components/period-fields";
import { Severity, worstSeverity } from "../components/severity";
import { usePeriod } from "../data/chosen-period";
import { useNewestIdentification } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { elementName } from "../format/names";
import { t } from "../messages/messages";
import { DERIVED, ElementHistories } from "../panels/element-histories";
import type { Alert } from "../schemas/alerts";
import type { Identification } from "../schemas/identifications";
import type { Document } from "../schemas/machines";
import { elementsOfEstimates } from "../words/elements";
import { OtherMachineSelect, useOtherMachine } from "./other-machine";

const RANGES: [string, string, number][] = [
  ["month", t("n1Month"), 31],
  ["quarter", t("n3Months"), 92],
  ["year", t("n1Year"), 366],
  ["all", t("wholeTime"), Infinity],
];
/** Alerts that are marked in the trends. */
const MAX_ALERTS = 200;
/** The API's scope of identifications pooled over several runs. */
const POOLED = "gathered";

export function TrendsTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const period = usePeriod();
  const other = useOtherMachine(machine.id);
  const { newest, none, failure, list } = useNewestIdentification(machine.id);
  const loaded = useResource<Alert[]>(`/machines/${machine.id}/alerts?limit=${MAX_ALERTS}`, 30_000);
  const alerts = loaded.data ?? [];
  const elements = newest ? elementsOf(newest) : [];
  const element = chosenElement(machine, elements, alerts, query.get("element"));
  const settled = loaded.data || loaded.failure ? element : undefined;
  useEffect(() => {
    // A later alert does not change what is being looked at.
    if (settled && !query.get("element")) replaceQuery({ element: settled });
  }, [settled, query]);
  if (none) return <NoIdentification />;
  if (!newest || !element) return <PendingPanel title={t("trends")} failure={failure} />;
  const range = query.get("range") ?? "all";
  const isFree = period.from !== null || period.to !== null;
  return (
    <>
      <NewestNotice failure={failure} list={list} />
      <Panel title={t("selection")}>
        <div class="choices">
          <ElementButtons elements={elements} chosen={element} alerts={alerts} />
          <RangeButtons chosen={isFree ? "" : range} />
          <PeriodFields {...period} />
          <OtherMachineSelect machine={machine} chosen={other} label={t("besideMachine")} />
          <PooledSwitch checked={query.get("scope") === POOLED} />
        </div>
        <Truncated shown={alerts.length} limit={MAX_ALERTS} of={t("alertsOfTheMachine")} />
      </Panel>
      <ElementHistories
        key={[element, range, query.get("scope"), period.first, period.last, other].join()}
        shown={period}
        machine={machine.id}
        rotation={machine.rotation}
        element={element}
        names={namesOf(newest, element)}
        newest={newest}
        shownDays={isFree ? Infinity : (RANGES.find(([id]) => id === range)?.[2] ?? Infinity)}
        scope={query.get("scope") ?? "run"}
        alerts={alerts}
        beside={other}
      />
    </>
  );
}

function elementsOf(newest: Identification): string[] {
  return [...elementsOfEstimates(newest.estimates), ...(newest.derived.length > 0 ? [DERIVED] : [])];
}

/** The element that the address names, else one with an open alert, else the first coupling, else the first of all. */
function chosenElement(machine: Document, elements: string[], alerts: Alert[], named: string | null): string | undefined {
  const alerted = alerts.find((one) => !one.closed_at)?.element;
  const coupling = machine.couplings[0] && `coupling.${machine.couplings[0].id}`;
  return [named, alerted, coupling, elements[0]].find((one) => one && elements.includes(one)) ?? undefined;
}

function namesOf(newest: Identification, element: string): string[] {
  if (element === DERIVED) return newest.derived.map((one) => one.name);
  return newest.estimates.filter((one) => one.element === element).map((one) => one.parameter);
}

function ElementButtons({ elements, chosen, alerts }: { elements: string[]; chosen: string; alerts: Alert[] }) {
  const open = alerts.filter((one) => !one.closed_at);
  return (
    <span class="buttons" role="group" aria-label={t("element")}>
      {elements.map((one) => (
        <button key={one} type="button" aria-pressed={one === chosen} onClick={() => replaceQuery({ element: one })}>
          <WorstOf alerts={open.filter((alert) => alert.element === one)} />
          {elementName(one)}
        </button>
      ))}
    </span>
  );
}

function WorstOf({ alerts }: { alerts: Alert[] }) {
  const severity = worstSeverity(alerts.map((one) => one.severity));
  return severity ? <><Severity severity={severity} word={false} /> </> : null;
}

function RangeButtons({ chosen }: { chosen: string }) {
  return (
    <span class="buttons" role="group" aria-label={t("timeRange")}>
      {RANGES.map(([id, label]) => (
        <button key={id} type="button" aria-pressed={id === chosen} onClick={() => replaceQuery({ range: id, from: null, to: null })}>
          {label}
        </button>
      ))}
    </span>
  );
}

function PooledSwitch({ checked }: { checked: boolean }) {
  return (
    <label class="switch">
      <input type="checkbox" checked={checked} onChange={(event) => replaceQuery({ scope: event.currentTarget.checked ? POOLED : null })} />
      {t("newestRunsPooled")}
    </label>
  );
}
