// Add a subscription to alerts.
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import type { NewSubscription } from "../schemas/subscriptions";
import { FormDialog } from "./form-dialog";

const CHANNELS: [string, string][] = [
  ["webhook", "webhook"],
  ["alertmanager", "Prometheus Alertmanager"],
  ["email", "e-mail"],
  ["zenoh", "the plant's own network (zenoh)"],
];

export function SubscriptionDialog({ onAdded, onClose }: { onAdded: (one: NewSubscription) => void; onClose: () => void }) {
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const body = { kind: form.get("kind"), name: String(form.get("name")).trim(), target: String(form.get("target")).trim() };
    onAdded(await post<NewSubscription>("/subscriptions", body, null, keys));
    refetch("/subscriptions");
  };
  return (
    <FormDialog title="Add a subscription" button="Add" named={false} onSubmit={submit} onClose={onClose}>
      <label>
        Channel
        <select name="kind">
          {CHANNELS.map(([kind, label]) => (
            <option key={kind} value={kind}>
              {label}
            </option>
          ))}
        </select>
      </label>
      <label>
        Name
        <input name="name" required maxLength={120} />
      </label>
      <label>
        Address: a URL, or e-mail addresses separated by commas; empty for zenoh
        <input name="target" maxLength={2000} />
      </label>
    </FormDialog>
  );
}
