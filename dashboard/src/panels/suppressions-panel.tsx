// Suppressed and shelved alerts of a machine: what is in force, how it begins and ends.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { EndSuppressionDialog, SuppressDialog } from "../dialogs/suppression-dialogs";
import { words } from "../format/names";
import type { Suppression } from "../schemas/alerts";
import type { Document } from "../schemas/machines";
import { suppressionScope } from "../words/alert-states";

const LIMIT = 200;

export function SuppressionsPanel({ machine }: { machine: Document }) {
  const [suppresses, setSuppresses] = useState(false);
  const [ended, setEnded] = useState<Suppression | null>(null);
  const result = useResource<Suppression[]>(`/machines/${machine.id}/suppressions?limit=${LIMIT}`, 15_000);
  return (
    <Panel
      title="Suppressed and shelved alerts"
      aside={
        <button type="button" onClick={() => setSuppresses(true)}>
          Suppress …
        </button>
      }
    >
      <Loaded result={result} lines={4}>
        {(all) => (all.length === 0 ? <Empty>No alert is suppressed or shelved.</Empty> : <Table all={all} onEnd={setEnded} />)}
      </Loaded>
      {suppresses && <SuppressDialog machine={machine} onClose={() => setSuppresses(false)} />}
      {ended && <EndSuppressionDialog suppression={ended} onClose={() => setEnded(null)} />}
    </Panel>
  );
}

function Table({ all, onEnd }: { all: Suppression[]; onEnd: (one: Suppression) => void }) {
  return (
    <Scroll label="Table">
      <table class="suppressions">
        <thead>
          <tr>
            <th>Kind</th>
            <th>Scope</th>
            <th>Since</th>
            <th>Until</th>
            <th>By</th>
            <th>Comment</th>
            <th>
              <span class="hidden">Actions</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {all.map((one) => (
            <tr key={one.id}>
              <td>{words(one.kind)}</td>
              <td>{suppressionScope(one)}</td>
              <td>
                <Time at={one.since} />
              </td>
              <td>{one.until ? <Time at={one.until} /> : "ended by hand"}</td>
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
      <Truncated shown={all.length} limit={LIMIT} which="oldest" />
    </Scroll>
  );
}
