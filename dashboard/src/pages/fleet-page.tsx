// All machines, found by name and sorted by urgency, name or plant.
import { link, replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { useResource } from "../data/resource";
import { rich, t } from "../messages/messages";
import { FleetTable } from "../panels/fleet-table";
import type { Fleet, FleetMachine } from "../schemas/machines";
import { needOrder, needs } from "../words/needs";

const POLL_MS = 5000;
/** The API's limit for the fleet. */
const LIMIT = 1000;

type Compare = (a: FleetMachine, b: FleetMachine) => number;
type Order = "urgency" | "name" | "plant";

const BY_NAME: Compare = (a, b) => a.name.localeCompare(b.name);
const COMPARE: Record<Order, Compare> = {
  urgency: (a, b) => needOrder(b) - needOrder(a) || urgency(b) - urgency(a) || BY_NAME(a, b),
  name: BY_NAME,
  plant: (a, b) => a.plant.localeCompare(b.plant) || BY_NAME(a, b),
};

export function FleetPage() {
  const { query } = useStore(route);
  const result = useResource<Fleet>("/fleet", POLL_MS);
  const search = (query.get("sought") ?? "").toLowerCase();
  const order = (query.get("order") ?? "urgency") as Order;
  return (
    <>
      <h1>{t("fleet")}</h1>
      <Panel title={t("machines")} aside={<SearchAndOrder search={search} order={order} />}>
        <p class="screen">
          <a href={link(["wall"])}>{t("wallView")}</a>
        </p>
        <Loaded result={result} lines={12}>
          {({ machines, since }) => (
            <>
              <Totals machines={machines} />
              <Truncated shown={machines.length} limit={LIMIT} which="first" />
              <Machines all={machines} found={machines.filter((one) => matches(one, search)).sort(COMPARE[order])} since={since} />
            </>
          )}
        </Loaded>
      </Panel>
    </>
  );
}

function SearchAndOrder({ search, order }: { search: string; order: Order }) {
  return (
    <div class="choices">
      <label class="switch">
        {t("find")} <input type="search" value={search} size={14} onInput={(event) => replaceQuery({ sought: event.currentTarget.value || null })} />
      </label>
      <label class="switch">
        {t("sort")}{" "}
        <select value={order} onChange={(event) => replaceQuery({ order: event.currentTarget.value })}>
          <option value="urgency">{t("whatNeedsAPerson")}</option>
          <option value="name">{t("byName")}</option>
          <option value="plant">{t("plant")}</option>
        </select>
      </label>
    </div>
  );
}

function Machines({ all, found, since }: { all: FleetMachine[]; found: FleetMachine[]; since: string }) {
  if (all.length === 0) {
    return (
      <Empty>
        {rich("noMachineYet", { command: <code>rundown document examples/motor-pump.yaml | curl -X POST …/api/v1/machines …</code> })}
      </Empty>
    );
  }
  if (found.length === 0) return <Empty>{t("noMachineMatches")}</Empty>;
  return <FleetTable machines={found} since={since} />;
}

function matches(one: FleetMachine, search: string): boolean {
  return `${one.plant} ${one.id} ${one.name}`.toLowerCase().includes(search);
}

function urgency(one: FleetMachine): number {
  return 1e6 * (one.open_alerts.danger ?? 0) + 1e3 * (one.open_alerts.alert ?? 0) + one.unacknowledged;
}

function Totals({ machines }: { machines: FleetMachine[] }) {
  const open = (severity: string) => machines.filter((one) => (one.open_alerts[severity] ?? 0) > 0).length;
  const turning = machines.filter((one) => !["stopped", "unknown"].includes(one.state)).length;
  const unacknowledged = machines.reduce((sum, one) => sum + one.unacknowledged, 0);
  const needing = machines.filter((one) => needs(one).length > 0).length;
  const figures: [number, string][] = [
    [machines.length, machines.length === 1 ? t("oneMachine") : t("machinesCount")],
    [turning, t("turning")],
    [machines.filter((one) => one.open_run).length, t("inARun")],
    [open("danger"), t("inDanger")],
    [open("alert"), t("withAnAlert")],
    [unacknowledged, unacknowledged === 1 ? t("alertNotAcknowledged") : t("alertsNotAcknowledged")],
    [needing, needing === 1 ? t("needsAPerson") : t("needAPerson")],
  ];
  return (
    <dl class="totals">
      {figures.map(([count, label]) => (
        <div key={label}>
          <dd class="figure">{count}</dd>
          <dt>{label}</dt>
        </div>
      ))}
    </dl>
  );
}
