// A list of alerts, what happened to each, and what can be done to it.
import { useState } from "preact/hooks";
import { AlertDialog } from "../dialogs/alert-action-dialog";
import { calls, DEEDS, possible, stateInWords, type Deed } from "../words/alert-states";
import { MOST_EVENTS } from "../data/alerts-at-time";
import type { Alert, AlertEvent, Evidence } from "../schemas/answers";
import { elementName, number, quantity, utc } from "../words/format";
import { Cut, Empty, Severity, Shown, Time } from "../components/parts";
import { useResource, type Answer } from "../data/resource";
import { link } from "../browser/router";

export function Alerts(props: { answer: Answer<Alert[]>; machines?: boolean; none: string }) {
  const [asked, setAsked] = useState<{ alert: Alert; deed: Deed } | null>(null);
  return (
    <>
      <Shown answer={props.answer} lines={4}>
        {(alerts) =>
          alerts.length === 0 ? (
            <Empty>{props.none}</Empty>
          ) : (
            <ul class="alarms">
              {alerts.map((alert) => (
                <Row key={alert.id} alert={alert} machine={props.machines ?? false} onAsk={(deed) => setAsked({ alert, deed })} />
              ))}
            </ul>
          )
        }
      </Shown>
      {asked && <AlertDialog alert={asked.alert} deed={asked.deed} onClose={() => setAsked(null)} />}
    </>
  );
}

function Row({ alert, machine, onAsk }: { alert: Alert; machine: boolean; onAsk: (deed: Deed) => void }) {
  const [open, setOpen] = useState(false);
  return (
    <li class={`alarm ${alert.closed_at ? "closed" : ""} ${calls(alert) ? "calls" : ""}`} data-alert={alert.id}>
      <div class="head">
        <Severity severity={alert.severity} seen={!calls(alert)} />
        {machine && <a href={link(["machines", alert.machine])}>{alert.machine}</a>}
        <a href={link(["machines", alert.machine, "trends"], { element: alert.element })}>{elementName(alert.element)}</a>
        <span class="rule">{alert.rule.replaceAll("_", " ")}</span>
        <span class="state">{stateInWords(alert.state)}</span>
        <span class="space" />
        <span title={`first measured ${utc(alert.first_measured_at)}, last ${utc(alert.measured_at)}, opened ${utc(alert.opened_at)}`}>
          <Time at={alert.opened_at} />
        </span>
      </div>
      <p>{alert.message}</p>
      <div class="buttons">
        {possible(alert).map((deed) => (
          <button type="button" key={deed} class={deed === "acknowledge" ? "strong" : undefined} onClick={() => onAsk(deed)}>
            {DEEDS[deed].button}
          </button>
        ))}
        <button type="button" class="quiet" aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? "▾" : "▸"} {alert.events} {alert.events === 1 ? "event" : "events"}
        </button>
      </div>
      {open && (
        <>
          <Basis evidence={alert.evidence} />
          <History alert={alert} />
        </>
      )}
    </li>
  );
}

/** What it rests on, where a diagnosis made it. */
function Basis({ evidence }: { evidence: Partial<Evidence> }) {
  const { moved = [], runners_up: others = [], since, runs, misalignment_force: force } = evidence;
  if (moved.length === 0) return null;
  return (
    <dl class="facts">
      <dt>Seen since</dt>
      <dd>
        <Time at={since} />, in {runs} runs in a row
      </dd>
      <dt>Moved most</dt>
      <dd>{moved.map((one) => `${one.parameter} ${one.sigma > 0 ? "+" : "−"}${number(Math.abs(one.sigma), 2)} σ`).join(", ")}</dd>
      {typeof force === "number" && (
        <>
          <dt>Misalignment force</dt>
          <dd>{quantity(force, "N")} at running speed</dd>
        </>
      )}
      {others.length > 0 && (
        <>
          <dt>Else it would be</dt>
          <dd>{others.map(causeInWords).join(", or ")}; these explain it less well</dd>
        </>
      )}
    </dl>
  );
}

function causeInWords({ kind, element }: { kind: string; element: string }): string {
  return element.startsWith(`${kind}.`) ? `${elementName(element)} by itself` : `${kind.replaceAll("_", " ")} of ${elementName(element)}`;
}

function History({ alert }: { alert: Alert }) {
  const answer = useResource<AlertEvent[]>(`/alerts/${alert.id}/events?limit=${MOST_EVENTS}`);
  return (
    <Shown answer={answer} lines={alert.events}>
      {(events) => (
        <>
          <Cut shown={events.length} most={MOST_EVENTS} what="oldest" />
          <ol class="history">
            {events.map((event) => (
              <li key={event.id}>
                <Time at={event.at} /> {event.kind.replaceAll("_", " ")}
                {event.by && <> by {event.by}</>}
                {event.state !== event.state_before && <>, now {stateInWords(event.state)}</>}
                {event.comment && <q>{event.comment}</q>}
              </li>
            ))}
          </ol>
        </>
      )}
    </Shown>
  );
}
