// Acknowledge, reset, shelve, unshelve or comment on an alert.
import { MAX_EVENTS } from "../data/alerts-at-time";
import { ApiError, get, getWithEtag, post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import { t, term } from "../messages/messages";
import type { Alert, AlertEvent } from "../schemas/alerts";
import { ALERT_ACTIONS, alertStateLabel, instructionDraft, type AlertAction } from "../words/alert-states";
import { author, CommentField, FormDialog } from "./form-dialog";

const SHIFT = 8;
const HOURS: [number, string][] = [
  [1, t("n1Hour")],
  [SHIFT, t("n8HoursOneShift")],
  [24, t("n1Day")],
  [168, t("n1Week")],
  [719, t("n30DaysTheMaximum")],
];

async function carryOut(alert: Alert, action: AlertAction, body: Record<string, string>, keys: IdempotencyKeys): Promise<void> {
  // The ETag is that of the alert as it is now: if it is no longer as shown, the error says what it has become.
  const [now, etag] = await getWithEtag<Alert>(`/alerts/${alert.id}`);
  if (!isRemark(action) && now.state !== alert.state) {
    const last = (await get<AlertEvent[]>(`/alerts/${alert.id}/events?limit=${MAX_EVENTS}`)).at(-1);
    throw new ApiError(409, t("theAlertHasChangedIt", { state: alertStateLabel(now.state), by: last?.by ?? t("somebodyElse") }));
  }
  if (!isRemark(action) && now.severity !== alert.severity) {
    throw new ApiError(409, t("theAlertHasChangedIts", { now: term(now.severity), before: term(alert.severity) }));
  }
  // An action can be undone and then taken anew, so it needs a new key: only a comment must not be there twice.
  await post(`/alerts/${alert.id}/${isRemark(action) ? "comments" : action}`, body, etag, isRemark(action) ? keys : undefined);
}

/** Whether it only adds words, whatever state the alert is in; an instruction is kept in the alert's history as well. */
function isRemark(action: AlertAction): boolean {
  return action === "comments" || action === "instruct";
}

export function AlertActionDialog({ alert, action, onClose }: { alert: Alert; action: AlertAction; onClose: () => void }) {
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const body: Record<string, string> = { by: author(form), comment: String(form.get("comment") ?? "") };
    if (action === "shelve") body.until = new Date(Date.now() + Number(form.get("hours")) * 3_600_000).toISOString();
    try {
      await carryOut(alert, action, body, keys);
    } finally {
      void refetch("/alerts");
      void refetch("/fleet");
    }
  };
  return (
    <FormDialog title={ALERT_ACTIONS[action].title} button={ALERT_ACTIONS[action].button.replace(" …", "")} onSubmit={submit} onClose={onClose}>
      <p class="subject">{alert.message}</p>
      {action === "shelve" && (
        <label>
          {t("shelveFor")}
          <select name="hours">
            {HOURS.map(([hours, words]) => (
              <option key={hours} value={hours} selected={hours === SHIFT}>
                {words}
              </option>
            ))}
          </select>
        </label>
      )}
      {action === "instruct" ? (
        <CommentField label={t("whatIsToBeDone")} required rows={7} text={instructionDraft(alert)} />
      ) : (
        <CommentField required={action === "comments"} />
      )}
    </FormDialog>
  );
}
