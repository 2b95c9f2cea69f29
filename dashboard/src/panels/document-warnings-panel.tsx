// What is hardly meant in a machine's document, as the service says it; nothing where there is none.
import { useUnits } from "../browser/units";
import { Panel } from "../components/panel";
import { t } from "../messages/messages";
import type { MachineRevision } from "../schemas/machines";
import { documentWarning } from "../words/document-warnings";

export function DocumentWarningsPanel({ document, revision, warnings }: MachineRevision) {
  const { length } = useUnits();
  if (warnings.length === 0) return null;
  return (
    <Panel title={t("warningsOfTheDocument")} aside={<p class="muted">{t("revisionIsUsedAsIt", { revision })}</p>}>
      <ul class="reasons">
        {warnings.map((one) => {
          const { where, words } = documentWarning(one, document, length);
          return (
            <li key={one}>
              {where && <strong>{where}: </strong>}
              {words}
            </li>
          );
        })}
      </ul>
    </Panel>
  );
}
