// Add a subscription to alerts.
import { useState } from "preact/hooks";
import { ReportSelect } from "../components/report-select";
import { ADDRESS_FORMS, CHANNELS } from "../declarations/channels";
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import { shownLocale, t, term } from "../messages/messages";
import type { NewSubscription, ReportInterval } from "../schemas/subscriptions";
import { FormDialog } from "./form-dialog";

export function SubscriptionDialog({ onAdded, onClose }: { onAdded: (one: NewSubscription) => void; onClose: () => void }) {
  const [kind, setKind] = useState<string>(CHANNELS[0].kind);
  // Kept here: a select whose value is a constant falls back to it whenever the page behind is refreshed.
  const [reports, setReports] = useState<ReportInterval | null>(null);
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const body = { kind: form.get("kind"), name: String(form.get("name")).trim(), target: String(form.get("target")).trim(), reports: form.get("reports") || null };
    onAdded(await post<NewSubscription>("/subscriptions", body, null, keys));
    void refetch("/subscriptions");
  };
  return (
    <FormDialog title={t("addASubscription")} button={t("add")} named={false} onSubmit={submit} onClose={onClose}>
      <label>
        {t("channel")}
        <select name="kind" value={kind} onChange={(event) => setKind(event.currentTarget.value)}>
          {CHANNELS.map(({ kind }) => (
            <option key={kind} value={kind}>
              {term(kind)}
            </option>
          ))}
        </select>
      </label>
      <label>
        {t("name")}
        <input name="name" required maxLength={120} />
      </label>
      <label>
        {t("addressOf", { forms: ADDRESS_FORMS[shownLocale] })}
        <input name="target" maxLength={2000} />
      </label>
      {CHANNELS.find((one) => one.kind === kind)?.reports && (
        <label>
          {t("reportsOfItsMachines")}
          <ReportSelect value={reports} onChoose={setReports} />
        </label>
      )}
    </FormDialog>
  );
}
