// Asks who does something to an alert, and why; says what the service answers.
import { DEEDS, type Deed } from "../words/alert-states";
import { MOST_EVENTS } from "../data/alerts-at-time";
import type { Alert, AlertEvent } from "../schemas/answers";
import { Failure, get, getToChange, post, type Attempt } from "../data/http-client";
import { AskDialog, Comment } from "./form-dialog";
import { refresh } from "../data/resource";

const SHIFT = 8;
const HOURS: [number, string][] = [
  [1, "1 hour"],
  [SHIFT, "8 hours, a shift"],
  [24, "1 day"],
  [168, "1 week"],
  [719, "30 days, the longest"],
];

async function carryOut(alert: Alert, deed: Deed, said: Record<string, string>, attempt: Attempt): Promise<void> {
  // The tag is that of the alert as it is now: if it is no longer what was shown, the service's answer says what it has become.
  const [now, etag] = await getToChange<Alert>(`/alerts/${alert.id}`);
  if (deed !== "comments" && now.state !== alert.state) {
    const last = (await get<AlertEvent[]>(`/alerts/${alert.id}/events?limit=${MOST_EVENTS}`)).at(-1);
    throw new Failure(409, `It is ${now.state.replaceAll("_", " ")} meanwhile, by ${last?.by ?? "somebody else"}. Look again.`);
  }
  if (deed !== "comments" && now.severity !== alert.severity) {
    throw new Failure(409, `It is of severity ${now.severity} meanwhile, no longer ${alert.severity}. Look again.`);
  }
  // A deed can be undone, and is done anew then: only a comment must not be there twice.
  await post(`/alerts/${alert.id}/${deed}`, said, etag, deed === "comments" ? attempt : undefined);
}

export function AlertDialog({ alert, deed, onClose }: { alert: Alert; deed: Deed; onClose: () => void }) {
  const submit = async (form: FormData, attempt: Attempt) => {
    const said: Record<string, string> = { by: String(form.get("by")).trim(), comment: String(form.get("comment") ?? "") };
    if (deed === "shelve") said.until = new Date(Date.now() + Number(form.get("hours")) * 3_600_000).toISOString();
    try {
      await carryOut(alert, deed, said, attempt);
    } finally {
      refresh("/alerts");
      refresh("/fleet");
    }
  };
  return (
    <AskDialog title={DEEDS[deed].title} button={DEEDS[deed].button.replace(" …", "")} onSubmit={submit} onClose={onClose}>
      <p class="subject">{alert.message}</p>
      {deed === "shelve" && (
        <label>
          For
          <select name="hours">
            {HOURS.map(([hours, words]) => (
              <option key={hours} value={hours} selected={hours === SHIFT}>
                {words}
              </option>
            ))}
          </select>
        </label>
      )}
      <Comment required={deed === "comments"} />
    </AskDialog>
  );
}
