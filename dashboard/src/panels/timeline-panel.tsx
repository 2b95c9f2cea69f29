// What people did to a machine, and where they write it down.
import { useState } from "preact/hooks";
import type { Document, TimelineEntry } from "../schemas/answers";
import { post, type Attempt } from "../data/http-client";
import { AskDialog } from "../dialogs/form-dialog";
import { Cut, Empty, Panel, Shown, Time } from "../components/parts";
import { refresh, useResource } from "../data/resource";

const SHOWN = 20;

export function Timeline({ machine }: { machine: Document }) {
  const [asked, setAsked] = useState(false);
  const answer = useResource<TimelineEntry[]>(`/machines/${machine.id}/timeline?limit=${SHOWN}`, 30_000);
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
              <Cut shown={entries.length} most={SHOWN} />
            </ul>
          )
        }
      </Shown>
      {asked && <Write machine={machine.id} onClose={() => setAsked(false)} />}
    </Panel>
  );
}

function Write({ machine, onClose }: { machine: string; onClose: () => void }) {
  const [opened] = useState(localNow);
  const submit = async (form: FormData, attempt: Attempt) => {
    const at = new Date(String(form.get("at"))).toISOString();
    const by = String(form.get("by")).trim();
    try {
      await post(`/machines/${machine}/timeline`, { at, kind: form.get("kind"), text: form.get("text"), by }, null, attempt);
    } finally {
      refresh(`/machines/${machine}/`);
    }
  };
  return (
    <AskDialog title="A note, or a maintenance" button="Write down" onSubmit={submit} onClose={onClose}>
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
        <input type="datetime-local" name="at" required defaultValue={opened} />
      </label>
      <label>
        What
        <textarea name="text" rows={3} required maxLength={2000} />
      </label>
    </AskDialog>
  );
}

/** The minute, as a field of local time wants it. */
function localNow(): string {
  const now = new Date();
  return new Date(now.getTime() - now.getTimezoneOffset() * 60_000).toISOString().slice(0, 16);
}
