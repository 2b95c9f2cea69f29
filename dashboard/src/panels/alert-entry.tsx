// One alert: what it says, its evidence and history, and the actions on it.
import { useState } from "preact/hooks";
import { link } from "../browser/router";
import { Loaded } from "../components/loading";
import { Truncated } from "../components/panel";
import { Severity } from "../components/severity";
import { Time } from "../components/time";
import { MAX_EVENTS } from "../data/alerts-at-time";
import { useResource } from "../data/resource";
import { causeLabel, findingLabel } from "../findings/findings";
import { elementName, elementOf, parameterName, words } from "../format/names";
import { number, quantity } from "../format/numbers";
import { utc } from "../format/times";
import { rich, t } from "../messages/messages";
import type { Alert, AlertEvent, Evidence } from "../schemas/alerts";
import { ALERT_ACTIONS, alertStateLabel, availableActions, isUnacknowledged, type AlertAction } from "../words/alert-states";
import { AlertAdvice } from "./alert-advice";

interface Props {
  alert: Alert;
  /** Its machine is named. */
  machine: boolean;
  /** Evidence and history are there at first. */
  opened?: boolean;
  onAction: (action: AlertAction) => void;
}

export function AlertEntry({ alert, machine, opened = false, onAction }: Props) {
  const [open, setOpen] = useState(opened);
  return (
    <li class={`alert-row ${alert.closed_at ? "closed" : ""} ${isUnacknowledged(alert) ? "unacknowledged" : ""}`} data-alert={alert.id}>
      <div class="head">
        <Severity severity={alert.severity} acknowledged={!isUnacknowledged(alert)} />
        {machine && <a href={link(["machines", alert.machine])}>{alert.machine}</a>}
        <a href={link(["machines", alert.machine, "trends"], { element: alert.element })}>{elementName(alert.element)}</a>
        <span class="rule">{findingLabel(alert.rule)}</span>
        <span class="state">{alertStateLabel(alert.state)}</span>
        <span class="space" />
        <span title={t("alertTimes", { first: utc(alert.first_measured_at), last: utc(alert.measured_at), opened: utc(alert.opened_at) })}>
          <Time at={alert.opened_at} />
        </span>
      </div>
      <p>{alert.message}</p>
      <div class="buttons">
        {availableActions(alert).map((action) => (
          <button type="button" key={action} class={action === "acknowledge" ? "strong" : undefined} onClick={() => onAction(action)}>
            {ALERT_ACTIONS[action].button}
          </button>
        ))}
        {!opened && <a href={link(["alerts", String(alert.id)])}>{t("judgeIt")}</a>}
        <button type="button" class="quiet" aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? "▾" : "▸"} {t(alert.events === 1 ? "oneEvent" : "manyEvents", { count: alert.events })}
        </button>
      </div>
      {open && (
        <>
          {alert.advice && <AlertAdvice advice={alert.advice} />}
          <EvidenceList evidence={alert.evidence} />
          <History alert={alert} />
        </>
      )}
    </li>
  );
}

/** The evidence of a diagnosis; nothing for other alerts. */
function EvidenceList({ evidence }: { evidence: Partial<Evidence> }) {
  const { moved = [], runners_up: alternatives = [], since, runs, misalignment_force: force } = evidence;
  if (moved.length === 0) return null;
  return (
    <dl class="facts">
      <dt>{t("observedSince")}</dt>
      <dd>
        {rich("inConsecutiveRuns", { time: <Time at={since} />, runs })}
      </dd>
      <dt>{t("largestChanges")}</dt>
      <dd>{largestOfEach(moved).map((one) => `${parameterName(one.parameter)} ${one.sigma > 0 ? "+" : "−"}${number(Math.abs(one.sigma), 2)} σ`).join(", ")}</dd>
      {typeof force === "number" && (
        <>
          <dt>{t("misalignmentForce")}</dt>
          <dd>{t("forceAtSpeed", { force: quantity(force, "N") })}</dd>
        </>
      )}
      {alternatives.length > 0 && (
        <>
          <dt>{t("alternativeCauses")}</dt>
          <dd>{t("lessLikely", { causes: alternatives.map(causeLabel).join(t("orBetweenCauses")) })}</dd>
        </>
      )}
    </dl>
  );
}

/** The most certain moved parameter of each element; its movement as a whole is stated above. */
function largestOfEach(moved: Evidence["moved"]): Evidence["moved"] {
  const largest = new Map<string, Evidence["moved"][number]>();
  for (const one of moved) {
    const element = elementOf(one.parameter);
    if (Math.abs(one.sigma) > Math.abs(largest.get(element)?.sigma ?? 0)) largest.set(element, one);
  }
  return [...largest.values()];
}

function History({ alert }: { alert: Alert }) {
  const result = useResource<AlertEvent[]>(`/alerts/${alert.id}/events?limit=${MAX_EVENTS}`);
  return (
    <Loaded result={result} lines={alert.events}>
      {(events) => (
        <>
          <Truncated shown={events.length} limit={MAX_EVENTS} which="oldest" />
          <ol class="history">
            {events.map((event) => (
              <li key={event.id}>
                <Time at={event.at} /> {words(event.kind)}
                {event.by && <> {t("byPerson", { by: event.by })}</>}
                {event.state !== event.state_before && <>{t("nowState", { state: alertStateLabel(event.state) })}</>}
                {event.comment && <q>{event.comment}</q>}
              </li>
            ))}
          </ol>
        </>
      )}
    </Loaded>
  );
}
