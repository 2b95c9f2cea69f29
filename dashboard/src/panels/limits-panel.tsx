// The limits of a machine, by kind of finding: who set them, and why.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { LimitsDialog } from "../dialogs/limits-dialog";
import { FINDING_KINDS, findingLabel, levelText, type FindingKind } from "../findings/findings";
import { elementName } from "../format/names";
import { rich, t } from "../messages/messages";
import type { Limits, LimitsVersion, Rule } from "../schemas/alerts";
import type { Document } from "../schemas/machines";

export function LimitsPanel({ machine }: { machine: Document }) {
  const [changed, setChanged] = useState<FindingKind | null>(null);
  const result = useResource<LimitsVersion>(`/machines/${machine.id}/limits`);
  return (
    <Panel title={t("limitsTitle")}>
      <Loaded result={result} lines={12}>
        {(found) => (
          <>
            <p class="muted">
              {found.version === 0 ? (
                t("theDefaultLimits")
              ) : (
                <>
                  {rich("limitsVersion", { version: found.version, time: <Time at={found.set_at} />, by: found.by, comment: found.comment })}
                </>
              )}
            </p>
            <LimitTable limits={found.limits} onChange={setChanged} />
            <ElementLimits limits={found.limits} />
            {changed && <LimitsDialog machine={machine.id} kind={changed} shown={found} onClose={() => setChanged(null)} />}
          </>
        )}
      </Loaded>
    </Panel>
  );
}

function LimitTable({ limits, onChange }: { limits: Limits; onChange: (kind: FindingKind) => void }) {
  return (
    <Scroll label={t("table")}>
      <table class="limits">
        <thead>
          <tr>
            <th>{t("finding")}</th>
            <th>{t("alertFrom")}</th>
            <th>{t("dangerFrom")}</th>
            <th class="number" title={t("mustShowIt")}>
              {t("onDelay")}
            </th>
            <th class="number" title={t("mustNoLongerShowIt")}>
              {t("offDelay")}
            </th>
            <th class="number">{t("hysteresis")}</th>
            <th>{t("latching")}</th>
            <th>
              <span class="hidden">{t("actions")}</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {FINDING_KINDS.map((kind) => (
            <LimitRow key={kind} kind={kind} rule={limits[kind]} onChange={() => onChange(kind)} />
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function LimitRow({ kind, rule, onChange }: { kind: FindingKind; rule: Rule; onChange: () => void }) {
  return (
    <tr data-rule={kind}>
      <th scope="row">{findingLabel(kind)}</th>
      <td>{levelText(rule.alert)}</td>
      <td>{levelText(rule.danger)}</td>
      <td class="number">{t("inARow", { count: rule.on_delay })}</td>
      <td class="number">{t("inARow", { count: rule.off_delay })}</td>
      <td class="number">{Math.round(100 * rule.hysteresis)} %</td>
      <td>{rule.latching ? t("yes") : t("no")}</td>
      <td>
        <button type="button" onClick={onChange} aria-label={t("changeLimitsOf", { finding: findingLabel(kind) })}>
          {t("changeDots")}
        </button>
      </td>
    </tr>
  );
}

/** Limits that single elements have of their own. */
function ElementLimits({ limits }: { limits: Limits }) {
  const own = Object.entries(limits.elements);
  if (own.length === 0) return null;
  return (
    <>
      <h3>{t("limitsOfSingleElements")}</h3>
      <ul>
        {own.flatMap(([element, rules]) =>
          Object.entries(rules).map(([kind, rule]) => (
            <li key={`${element} ${kind}`}>
              {t("elementLimits", { element: elementName(element), finding: findingLabel(kind), alert: levelText(rule.alert), danger: levelText(rule.danger) })}
            </li>
          )),
        )}
      </ul>
    </>
  );
}
