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
import type { Limits, LimitsVersion, Rule } from "../schemas/alerts";
import type { Document } from "../schemas/machines";

export function LimitsPanel({ machine }: { machine: Document }) {
  const [changed, setChanged] = useState<FindingKind | null>(null);
  const result = useResource<LimitsVersion>(`/machines/${machine.id}/limits`);
  return (
    <Panel title="Limits">
      <Loaded result={result} lines={12}>
        {(found) => (
          <>
            <p class="muted">
              {found.version === 0 ? (
                "The default limits."
              ) : (
                <>
                  Version {found.version}, set <Time at={found.set_at} /> by {found.by}: {found.comment}
                </>
              )}
            </p>
            <Table limits={found.limits} onChange={setChanged} />
            <ElementLimits limits={found.limits} />
            {changed && <LimitsDialog machine={machine.id} kind={changed} shown={found} onClose={() => setChanged(null)} />}
          </>
        )}
      </Loaded>
    </Panel>
  );
}

function Table({ limits, onChange }: { limits: Limits; onChange: (kind: FindingKind) => void }) {
  return (
    <Scroll label="Table">
      <table class="limits">
        <thead>
          <tr>
            <th>Finding</th>
            <th>Alert from</th>
            <th>Danger from</th>
            <th class="number" title="consecutive identifications that must show it">
              On-delay
            </th>
            <th class="number" title="consecutive identifications that must no longer show it">
              Off-delay
            </th>
            <th class="number">Hysteresis</th>
            <th>Latching</th>
            <th>
              <span class="hidden">Actions</span>
            </th>
          </tr>
        </thead>
        <tbody>
          {FINDING_KINDS.map((kind) => (
            <Row key={kind} kind={kind} rule={limits[kind]} onChange={() => onChange(kind)} />
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function Row({ kind, rule, onChange }: { kind: FindingKind; rule: Rule; onChange: () => void }) {
  return (
    <tr data-rule={kind}>
      <th scope="row">{findingLabel(kind)}</th>
      <td>{levelText(rule.alert)}</td>
      <td>{levelText(rule.danger)}</td>
      <td class="number">{rule.on_delay}</td>
      <td class="number">{rule.off_delay}</td>
      <td class="number">{Math.round(100 * rule.hysteresis)} %</td>
      <td>{rule.latching ? "yes" : "no"}</td>
      <td>
        <button type="button" onClick={onChange} aria-label={`Change limits of ${findingLabel(kind)}`}>
          Change …
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
      <h3>Limits of single elements</h3>
      <ul>
        {own.flatMap(([element, rules]) =>
          Object.entries(rules).map(([kind, rule]) => (
            <li key={`${element} ${kind}`}>
              {elementName(element)}, {findingLabel(kind)}: alert from {levelText(rule.alert)}; danger from {levelText(rule.danger)}
            </li>
          )),
        )}
      </ul>
    </>
  );
}
