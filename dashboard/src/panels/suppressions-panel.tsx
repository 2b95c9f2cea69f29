// Suppressed and shelved alerts of a machine: what is in force, how it begins and ends.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel, Truncated } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { EndSuppressionDialog, SuppressDialog } from "../dialogs/suppression-dialogs";
import { words } from "../format/names";
import { t } from "../messages/messages";
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
      title={t("suppressedAndShelvedAlerts")}
      aside={
        <button type="button" onClick={() => setSuppresses(true)}>
          {t("suppressDots")}
        </button>
      }
    >
      <Loaded result={result} lines={4}>
        {(all) => (all.length === 0 ? <Empty>{t("noAlertIsSuppressedOr")}</Empty> : <SuppressionTable all={all} onEnd={setEnded} />)}
      </Loaded>
      {suppresses && <SuppressDialog machine={machine} onClose={() => setSuppresses(false)} />}
      {ended && <EndSuppressionDialog suppression={ended} onClose={() => setEnded(null)} />}
    </Panel>
  );
}

function SuppressionTable({ all, onEnd }: { all: Suppression[]; onEnd: (one: Suppression) => void }) {
  return (
    <Scroll label={t("table")}>
      <table class="suppressions">
        <thead>
          <tr>
            <th>{t("kind")}</th>
            <th>{t("scope")}</th>
            <th>{t("since")}</th>
            <th>{t("until")}</th>
            <th>{t("byWhom")}</th>
            <th>{t("comment")}</th>
            <th>
              <span class="hidden">{t("actions")}</span>
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
              <td>{one.until ? <Time at={one.until} /> : t("endedByHand")}</td>
              <td>{one.by}</td>
              <td>{one.comment}</td>
              <td>
                <button type="button" onClick={() => onEnd(one)}>
                  {t("endDots")}
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
