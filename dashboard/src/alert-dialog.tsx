// Asks who does something to an alert, and why; says what the service answers.
import { useState } from "preact/hooks";
import { DEEDS, type Deed } from "./alert-words";
import type { Alert } from "./answers";
import { Failure, getToChange, post } from "./api";
import { Dialog } from "./dialog";
import { keepName, keptName } from "./person";
import { refresh } from "./resource";

const SHIFT = 8;
const HOURS: [number, string][] = [
  [1, "1 hour"],
  [SHIFT, "8 hours, a shift"],
  [24, "1 day"],
  [168, "1 week"],
  [719, "30 days, the longest"],
];

async function carryOut(alert: Alert, deed: Deed, said: Record<string, string>): Promise<void> {
  // The tag is that of the alert as it is now: if it is no longer what was shown, the service's answer says what it has become.
  const [now, etag] = await getToChange<Alert>(`/alerts/${alert.id}`);
  if (deed !== "comments" && now.state !== alert.state) {
    throw new Failure(409, `It is ${now.state.replaceAll("_", " ")} meanwhile: somebody else was here. Look again.`);
  }
  if (deed !== "comments" && now.severity !== alert.severity) {
    throw new Failure(409, `It is of severity ${now.severity} meanwhile, no longer ${alert.severity}. Look again.`);
  }
  await post(`/alerts/${alert.id}/${deed}`, said, etag);
}

export function AlertDialog(props: { alert: Alert; deed: Deed; onClose: () => void }) {
  const { alert, deed, onClose } = props;
  const [failure, setFailure] = useState<string | null>(null);
  const [busy, setBusy] = useState(false);
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    const by = String(form.get("by")).trim();
    const said: Record<string, string> = { by, comment: String(form.get("comment") ?? "") };
    if (deed === "shelve") said.until = new Date(Date.now() + Number(form.get("hours")) * 3_600_000).toISOString();
    keepName(by);
    setBusy(true);
    setFailure(null);
    try {
      await carryOut(alert, deed, said);
      onClose();
    } catch (error) {
      setFailure(error instanceof Failure ? error.message : String(error));
    } finally {
      setBusy(false);
      refresh("/alerts");
      refresh("/fleet");
    }
  };
  return (
    <Dialog title={DEEDS[deed].title} onClose={onClose}>
      <p class="subject">{alert.message}</p>
      <form onSubmit={submit}>
        <label>
          Your name
          <input name="by" required maxLength={120} autoComplete="name" defaultValue={keptName()} />
        </label>
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
        <label>
          Comment
          <textarea name="comment" rows={3} maxLength={2000} required={deed === "comments"} />
        </label>
        {failure && (
          <p class="trouble" role="alert">
            {failure}
          </p>
        )}
        <p class="buttons">
          <button type="submit" class="strong" disabled={busy}>
            {busy ? "…" : DEEDS[deed].button.replace(" …", "")}
          </button>
          <button type="button" onClick={onClose}>
            Cancel
          </button>
        </p>
      </form>
    </Dialog>
  );
}
