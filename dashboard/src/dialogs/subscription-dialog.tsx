// Add a subscription to alerts.
import { ADDRESS_FORMS, CHANNELS } from "../declarations/channels";
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import type { NewSubscription } from "../schemas/subscriptions";
import { FormDialog } from "./form-dialog";

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
          {CHANNELS.map(({ kind, title }) => (
            <option key={kind} value={kind}>
              {title}
            </option>
          ))}
        </select>
      </label>
      <label>
        Name
        <input name="name" required maxLength={120} />
      </label>
      <label>
        Address: {ADDRESS_FORMS}
        <input name="target" maxLength={2000} />
      </label>
    </FormDialog>
  );
}
