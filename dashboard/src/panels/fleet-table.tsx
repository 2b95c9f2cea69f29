// The machines of the fleet: their states, open alerts, last runs and identifications, and recent changes.
import { link } from "../browser/router";
import { useUnits } from "../browser/units";
import { OperatingState } from "../components/operating-state";
import { Scroll } from "../components/scroll";
import { Severity } from "../components/severity";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { when } from "../format/times";
import { stored, t, term } from "../messages/messages";
import type { FleetMachine } from "../schemas/machines";
import { alertTitle } from "../words/alert-states";
import { needs } from "../words/needs";

const SEVERITIES = ["danger", "alert"];

/** since: from when on changes are counted. */
export function FleetTable({ machines, since }: { machines: FleetMachine[]; since: string }) {
  return (
    <Scroll label={t("table")}>
      <table class="fleet">
        <thead>
          <tr>
            <th>{t("openAlerts")}</th>
            <th>{t("machine")}</th>
            <th>{t("needsAPersonTo")}</th>
            <th>{t("state")}</th>
            <th class="number">{t("speed")}</th>
            <th>{t("lastRun")}</th>
            <th>{t("lastIdentification")}</th>
            <th title={t("sinceWhen", { when: when(since) })}>{t("sinceYesterday")}</th>
          </tr>
        </thead>
        <tbody>
          {machines.map((one) => (
            <MachineRow key={one.id} one={one} />
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function MachineRow({ one }: { one: FleetMachine }) {
  const needed = needs(one, useUnits());
  return (
    <tr data-machine={one.id}>
      <td class="open" data-label={t("openAlerts")}>
        <OpenAlerts one={one} />
      </td>
      <td>
        <a href={link(["machines", one.id])}>{one.name}</a>
        <div class="muted">
          {one.plant} / {one.id}
        </div>
      </td>
      <td class="needs" data-label={t("needsAPersonTo")}>
        {needed.length === 0 && <span class="muted">{t("nothing")}</span>}
        {needed.map(({ words }) => (
          <div key={words}>{words}</div>
        ))}
      </td>
      <td data-label={t("state")}>
        <OperatingState state={one.state} />
        <div class="muted">
          <Time at={one.state_since} />
        </div>
      </td>
      <td class="number" data-label={t("speed")}><Speed rpm={one.speed_rpm} /></td>
      <td data-label={t("lastRun")}>
        <LastRun one={one} />
      </td>
      <td data-label={t("lastIdentification")} title={one.last_identification ? stored(one.last_identification.verdict) : undefined}>
        {one.last_identification ? (one.last_identification.accepted ? t("accepted") : t("crossNotAccepted")) : <span class="muted">{t("none")}</span>}
        <div class="muted">{one.last_identification && <Time at={one.last_identification.measured_at} />}</div>
      </td>
      <td data-label={t("sinceYesterday")}>{changesOf(one)}</td>
    </tr>
  );
}

function OpenAlerts({ one }: { one: FleetMachine }) {
  const open = SEVERITIES.filter((severity) => one.open_alerts[severity]);
  return (
    <>
      {open.length === 0 && <span class="muted">{t("none")}</span>}
      {open.map((severity) => (
        <span key={severity}>
          <Severity severity={severity} acknowledged={one.unacknowledged === 0} /> {one.open_alerts[severity]}
        </span>
      ))}
      {one.first_alert && (
        <a class="first-alert" href={link(["alerts", String(one.first_alert.id)])}>
          {alertTitle(one.first_alert)}
        </a>
      )}
      {one.unacknowledged > 0 && <span class="pill">{t("unacknowledgedCount", { count: one.unacknowledged })}</span>}
    </>
  );
}

function LastRun({ one }: { one: FleetMachine }) {
  if (one.open_run) {
    return (
      <label class="collecting">
        {term(one.open_run.kind)} <progress max={1} value={one.open_run.progress} aria-label={t("runIsBeingCollected", { id: one.open_run.id })} />
      </label>
    );
  }
  if (!one.last_run) return <span class="muted">{t("none")}</span>;
  return (
    <>
      {term(one.last_run.kind)}
      <div class="muted">
        <Time at={one.last_run.started_at} />
      </div>
    </>
  );
}

type ChangeName = "Run" | "AlertEvent" | "Note" | "Refusal" | "Revision" | "Identification";
type CountKey = `one${ChangeName}` | `many${ChangeName}s`;

const CHANGES: [keyof FleetMachine["happened"], one: CountKey, many: CountKey][] = [
  ["alert_events", "oneAlertEvent", "manyAlertEvents"],
  ["runs", "oneRun", "manyRuns"],
  ["identifications", "oneIdentification", "manyIdentifications"],
  ["timeline", "oneNote", "manyNotes"],
  ["refused", "oneRefusal", "manyRefusals"],
  ["revisions", "oneRevision", "manyRevisions"],
];

function changesOf({ happened }: FleetMachine) {
  const changes = CHANGES.filter(([what]) => happened[what] > 0).map(([what, one, many]) => t(happened[what] === 1 ? one : many, { count: happened[what] }));
  return changes.length > 0 ? changes.join(", ") : <span class="muted">{t("nothing")}</span>;
}
