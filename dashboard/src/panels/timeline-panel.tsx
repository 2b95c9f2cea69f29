// Notes and maintenance of a machine.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { TimelineDialog } from "../dialogs/timeline-dialog";
import { t, term } from "../messages/messages";
import type { Document, TimelineEntry } from "../schemas/machines";

const LIMIT = 20;

export function TimelinePanel({ machine }: { machine: Document }) {
  const [adds, setAdds] = useState(false);
  const result = useResource<TimelineEntry[]>(`/machines/${machine.id}/timeline?limit=${LIMIT}`, 30_000);
  return (
    <Panel
      title={t("notesAndMaintenance")}
      aside={
        <button type="button" onClick={() => setAdds(true)}>
          {t("addDots")}
        </button>
      }
    >
      <Loaded result={result} lines={2}>
        {(entries) =>
          entries.length === 0 ? (
            <Empty>{t("noNotesYet")}</Empty>
          ) : (
            <ul class="timeline">
              {entries.map((one) => (
                <li key={one.id}>
                  {one.kind === "maintenance" ? "✚" : "●"} <Time at={one.at} /> {term(one.kind)}, {one.by}: {one.text}
                </li>
              ))}
              <Truncated shown={entries.length} limit={LIMIT} />
            </ul>
          )
        }
      </Loaded>
      {adds && <TimelineDialog machine={machine.id} onClose={() => setAdds(false)} />}
    </Panel>
  );
}
