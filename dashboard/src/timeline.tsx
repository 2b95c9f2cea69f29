// What people did to a machine, and where they write it down.
import { useState } from "preact/hooks";
import type { Document, TimelineEntry } from "./answers";
import { Failure, post } from "./api";
import { Dialog } from "./dialog";
import { Empty, Panel, Shown, Time } from "./parts";
import { keepName, keptName } from "./person";
import { refresh, useResource } from "./resource";

export function Timeline({ machine }: { machine: Document }) {
  const [asked, setAsked] = useState(false);
  const answer = useResource<TimelineEntry[]>(`/machines/${machine.id}/timeline?limit=20`, 30_000);
  return (
    <Panel
      title="Notes and maintenance"
      aside={
        <button type="button" onClick={() => setAsked(true)}>
          Write …
        </button>
      }
    >
      <Shown answer={answer} lines={2}>
        {(entries) =>
          entries.length === 0 ? (
            <Empty>Nothing is noted.</Empty>
          ) : (
            <ul class="marks">
              {entries.map((one) => (
                <li key={one.id}>
                  {one.kind === "maintenance" ? "✚" : "●"} <Time at={one.at} /> {one.kind}, {one.by}: {one.text}
                </li>
              ))}
            </ul>
          )
        }
      </Shown>
      {asked && <Write machine={machine.id} onClose={() => setAsked(false)} />}
    </Panel>
  );
}

function Write({ machine, onClose }: { machine: string; onClose: () => void }) {
  const [failure, setFailure] = useState<string | null>(null);
  const submit = async (event: SubmitEvent) => {
    event.preventDefault();
    const form = new FormData(event.currentTarget as HTMLFormElement);
    const by = String(form.get("by")).trim();
    keepName(by);
    try {
      const at = new Date(String(form.get("at"))).toISOString();
      await post(`/machines/${machine}/timeline`, { at, kind: form.get("kind"), text: form.get("text"), by });
      onClose();
    } catch (error) {
      setFailure(error instanceof Failure ? error.message : String(error));
    } finally {
      refresh(`/machines/${machine}/`);
    }
  };
  const now = new Date();
  const local = new Date(now.getTime() - now.getTimezoneOffset() * 60_000).toISOString().slice(0, 16);
  return (
    <Dialog title="A note, or a maintenance" onClose={onClose}>
      <form onSubmit={submit}>
        <label>
          Kind
          <select name="kind">
            <option value="note">note</option>
            <option value="maintenance">maintenance: a new baseline begins</option>
            <option value="marker">marker</option>
          </select>
        </label>
        <label>
          When
          <input type="datetime-local" name="at" required defaultValue={local} />
        </label>
        <label>
          What
          <textarea name="text" rows={3} required maxLength={2000} />
        </label>
        <label>
          Your name
          <input name="by" required maxLength={120} autoComplete="name" defaultValue={keptName()} />
        </label>
        {failure && (
          <p class="trouble" role="alert">
            {failure}
          </p>
        )}
        <p class="buttons">
          <button type="submit" class="strong">
            Write down
          </button>
          <button type="button" onClick={onClose}>
            Cancel
          </button>
        </p>
      </form>
    </Dialog>
  );
}
