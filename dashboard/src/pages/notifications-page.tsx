// Who is told of alerts: subscriptions, what became of each message, and how one is added or turned off.
import { useState } from "preact/hooks";
import type { Delivery, NewSubscription, Subscription, TestOutcome } from "../schemas/answers";
import { Failure, getToChange, post, type Attempt } from "../data/http-client";
import { AskDialog } from "../dialogs/form-dialog";
import { Cut, Empty, Panel, Shown, Time } from "../components/parts";
import { refresh, useResource } from "../data/resource";

const SHOWN = 200;
const LOG = 20;

export function SubscriptionsPage() {
  const [adds, setAdds] = useState(false);
  const [secret, setSecret] = useState<NewSubscription | null>(null);
  const answer = useResource<Subscription[]>(`/subscriptions?limit=${SHOWN}`, 15_000);
  return (
    <>
      <h1>Who is told</h1>
      <Panel
        title="Subscriptions"
        aside={
          <button type="button" onClick={() => setAdds(true)}>
            Add …
          </button>
        }
      >
        {secret?.secret && (
          <p class="secret" role="status">
            The secret that signs messages to {secret.name}, shown this once: <code>{secret.secret}</code>
          </p>
        )}
        <Shown answer={answer} lines={6}>
          {(all) =>
            all.length === 0 ? (
              <Empty>Nobody is told of alerts yet.</Empty>
            ) : (
              <>
                {all.map((one) => (
                  <One key={one.id} one={one} />
                ))}
                <Cut shown={all.length} most={SHOWN} what="oldest" />
              </>
            )
          }
        </Shown>
      </Panel>
      {adds && <Add onAdded={setSecret} onClose={() => setAdds(false)} />}
    </>
  );
}

function One({ one }: { one: Subscription }) {
  const [open, setOpen] = useState(false);
  const [said, setSaid] = useState<string | null>(null);
  const attempt = async (work: () => Promise<string>) => {
    try {
      setSaid(await work());
    } catch (error) {
      setSaid(error instanceof Failure ? error.message : String(error));
    }
    refresh("/subscriptions");
  };
  const turn = (what: "enable" | "disable") =>
    attempt(async () => {
      const [, etag] = await getToChange<Subscription>(`/subscriptions/${one.id}`);
      await post(`/subscriptions/${one.id}/${what}`, null, etag);
      return `${what}d`;
    });
  const test = () =>
    attempt(async () => {
      const { result, answer } = await post<TestOutcome>(`/subscriptions/${one.id}/test`, null);
      return `test message ${result}: ${answer}`;
    });
  return (
    <section class="subscription" data-subscription={one.id}>
      <h3>
        {one.name} <span class="muted">{one.kind}</span> {one.target}
      </h3>
      <p>
        {one.state === "active" ? "active" : `✕ disabled: ${one.reason ?? "no reason is known"}`}; added <Time at={one.created_at} />
      </p>
      <p class="buttons">
        {one.state === "active" ? (
          <button type="button" onClick={() => turn("disable")}>
            Disable
          </button>
        ) : (
          <button type="button" onClick={() => turn("enable")}>
            Enable
          </button>
        )}
        <button type="button" onClick={test}>
          Send a test
        </button>
        <button type="button" class="quiet" aria-expanded={open} onClick={() => setOpen(!open)}>
          {open ? "▾" : "▸"} deliveries
        </button>
        <span role="status">{said}</span>
      </p>
      {open && <Log subscription={one.id} />}
    </section>
  );
}

function Log({ subscription }: { subscription: number }) {
  const answer = useResource<Delivery[]>(`/subscriptions/${subscription}/deliveries?limit=${LOG}`, 5000);
  return (
    <Shown answer={answer} lines={LOG}>
      {(all) =>
        all.length === 0 ? (
          <Empty>Nothing was delivered yet.</Empty>
        ) : (
          <div class="scroll">
            <table>
              <thead>
                <tr>
                  <th>Event</th>
                  <th>Alert</th>
                  <th>State</th>
                  <th class="number">Tries</th>
                  <th>Last try</th>
                  <th>Answer</th>
                </tr>
              </thead>
              <tbody>
                {all.map((one) => (
                  <tr key={one.id}>
                    <td>{one.event}</td>
                    <td>{one.alert}</td>
                    <td>{one.state.replaceAll("_", " ")}</td>
                    <td class="number">{one.attempts}</td>
                    <td>
                      <Time at={one.last_try_at} />
                    </td>
                    <td>{one.answer ?? "–"}</td>
                  </tr>
                ))}
              </tbody>
            </table>
            <Cut shown={all.length} most={LOG} />
          </div>
        )
      }
    </Shown>
  );
}

function Add({ onAdded, onClose }: { onAdded: (one: NewSubscription) => void; onClose: () => void }) {
  const submit = async (form: FormData, attempt: Attempt) => {
    const said = { kind: form.get("kind"), name: String(form.get("name")).trim(), target: String(form.get("target")).trim() };
    onAdded(await post<NewSubscription>("/subscriptions", said, null, attempt));
    refresh("/subscriptions");
  };
  return (
    <AskDialog title="Tell of alerts" button="Add" named={false} onSubmit={submit} onClose={onClose}>
      <label>
        How
        <select name="kind">
          <option value="webhook">webhook</option>
          <option value="alertmanager">Prometheus Alertmanager</option>
          <option value="email">e-mail</option>
          <option value="zenoh">the plant's own network (zenoh)</option>
        </select>
      </label>
      <label>
        Name
        <input name="name" required maxLength={120} />
      </label>
      <label>
        Address: a URL, or e-mail addresses with commas between; none for zenoh
        <input name="target" maxLength={2000} />
      </label>
    </AskDialog>
  );
}
