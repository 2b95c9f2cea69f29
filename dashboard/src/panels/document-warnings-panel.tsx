// What is hardly meant in a machine's document, and whether its train would run, as the service says it; nothing where there is none.
import { useUnits } from "../browser/units";
import { Loaded, useSaysThatItWaits } from "../components/loading";
import { Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { t } from "../messages/messages";
import type { MachineRevision, Stability } from "../schemas/machines";
import { documentWarning } from "../words/document-warnings";

export function DocumentWarningsPanel({ id, document, revision, warnings }: MachineRevision) {
  const { length } = useUnits();
  const stability = useResource<Stability>(`/machines/${id}/stability`);
  const waits = useSaysThatItWaits(stability.data === undefined);
  const all = [...warnings, ...(stability.data?.warnings ?? [])];
  if (all.length === 0 && !waits) return null;
  return (
    <Panel title={t("warningsOfTheDocument")} aside={<p class="muted">{t("revisionIsUsedAsIt", { revision })}</p>}>
      {all.length > 0 && (
        <ul class="reasons">
          {all.map((one) => {
            const { where, words } = documentWarning(one, document, length);
            return (
              <li key={one}>
                {where && <strong>{where}: </strong>}
                {words}
              </li>
            );
          })}
        </ul>
      )}
      {waits && (
        <>
          <p class="muted">{t("whetherTheTrainWouldRun")}</p>
          <Loaded result={stability} lines={1}>
            {() => null}
          </Loaded>
        </>
      )}
    </Panel>
  );
}
