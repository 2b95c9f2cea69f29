// Machines, elements and rules whose alerts call nobody for a while: what is in force, how it begins and ends.
import { useState } from "preact/hooks";
import type { Document, Suppression } from "../schemas/answers";
import { getToChange, post, type Attempt } from "../data/http-client";
import { AskDialog, Comment } from "../dialogs/form-dialog";
import { elementName, elementsOfDocument } from "../words/format";
import { Cut, Empty, Panel, Shown, Time } from "../components/parts";
import { refresh, useResource } from "../data/resource";
import { RULES } from "../words/findings";

const SHOWN = 200;

export function SuppressionsPanel({ machine }: { machine: Document }) {
  const [begins, setBegins] = useState(false);
  const [ended, setEnded] = useState<Suppression | null>(null);
  const answer = useResource<Suppression[]>(`/machines/${machine.id}/suppressions?limit=${SHOWN}`, 15_000);
  return (
    <Panel
      title="Alerts that call nobody"
      aside={
        <button type="button" onClick={() => setBegins(true)}>
          Suppress …
        </button>
      }
    >
      <Shown answer={answer} lines={4}>
        {(all) => (all.length === 0 ? <Empty>Nothing is suppressed or shelved: every alert calls.</Empty> : <Table all={all} onEnd={setEnded} />)}
      </Shown>
      {begins && <Begin machine={machine} onClose={() => setBegins(false)} />}
      {ended && <End one={ended} onClose={() => setEnded(null)} />}
    </Panel>
  );
}

function Table({ all, onEnd }: { all: Suppression[]; onEnd: (one: Suppression) => void }) {
  return (
    <div class="scroll">
      <table class="suppressions">
        <thead>
          <tr>
            <th>What</th>
            <th>Of</th>
            <th>Since</th>
            <th>Until</th>
            <th>By</th>
            <th>Comment</th>
            <th />
          </tr>
        </thead>
        <tbody>
          {all.map((one) => (
            <tr key={one.id}>
              <td>{one.kind.replaceAll("_", " ")}</td>
              <td>{scope(one)}</td>
              <td>
                <Time at={one.since} />
              </td>
              <td>{one.until ? <Time at={one.until} /> : "ended by a person"}</td>
              <td>{one.by}</td>
              <td>{one.comment}</td>
              <td>
                <button type="button" onClick={() => onEnd(one)}>
                  End …
                </button>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <Cut shown={all.length} most={SHOWN} what="oldest" />
    </div>
  );
}

function scope({ rule, element }: Suppression): string {
  if (!rule && !element) return "the whole machine";
  return [rule?.replaceAll("_", " "), element && elementName(element)].filter(Boolean).join(", ");
}

function Begin({ machine, onClose }: { machine: Document; onClose: () => void }) {
  const submit = async (form: FormData, attempt: Attempt) => {
    const until = String(form.get("until"));
    const said = {
      kind: form.get("kind"),
      rule: form.get("rule") || null,
      element: form.get("element") || null,
      until: until ? new Date(until).toISOString() : null,
      by: String(form.get("by")).trim(),
      comment: form.get("comment"),
    };
    await post(`/machines/${machine.id}/suppressions`, said, null, attempt);
    renew(machine.id);
  };
  return (
    <AskDialog title="Suppress alerts" button="Suppress" onSubmit={submit} onClose={onClose}>
      <label>
        Why
        <select name="kind">
          <option value="out_of_service">out of service, such as a probe or a machine in maintenance</option>
          <option value="suppressed_by_design">suppressed by design: known, and meant so</option>
        </select>
      </label>
      <label>
        Rule
        <select name="rule">
          <option value="">all</option>
          {RULES.map((one) => (
            <option key={one} value={one}>
              {one.replaceAll("_", " ")}
            </option>
          ))}
        </select>
      </label>
      <label>
        Element
        <select name="element">
          <option value="">all</option>
          {elementsOfDocument(machine).map((one) => (
            <option key={one} value={one}>
              {elementName(one)}
            </option>
          ))}
        </select>
      </label>
      <label>
        Until, or empty: until a person ends it
        <input type="datetime-local" name="until" />
      </label>
      <Comment />
    </AskDialog>
  );
}

function End({ one, onClose }: { one: Suppression; onClose: () => void }) {
  const submit = async (form: FormData, attempt: Attempt) => {
    const [, etag] = await getToChange<Suppression>(`/suppressions/${one.id}`);
    await post(`/suppressions/${one.id}/end`, { by: String(form.get("by")).trim(), comment: form.get("comment") }, etag, attempt);
    renew(one.machine);
  };
  return (
    <AskDialog title={`End: ${one.kind.replaceAll("_", " ")}, ${scope(one)}`} button="End" onSubmit={submit} onClose={onClose}>
      <p class="muted">Alerts whose cause is there call again.</p>
      <Comment />
    </AskDialog>
  );
}

function renew(machine: string): void {
  refresh(`/machines/${machine}/`);
  refresh("/alerts");
  refresh("/fleet");
}
