// A comparison of the identification that is shown with an earlier one.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { queryString } from "../data/http-client";
import { useResource } from "../data/resource";
import { elementName, parameterName } from "../format/names";
import { number, percent, scaleOf, type Scale } from "../format/numbers";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import type { ComparedChange, Comparison, Estimate, IdentificationSummary } from "../schemas/identifications";

/** Changes of more than so many standard errors are highlighted. */
const SIGNIFICANT = 3;

interface Props {
  shown: string;
  all: IdentificationSummary[];
  /** Estimates of the identification that is shown, which have the units. */
  estimates: Estimate[];
}

export function ComparisonPanel({ shown, all, estimates }: Props) {
  const { query } = useStore(route);
  const earlier = query.get("against") ?? "";
  const result = useResource<Comparison>(earlier ? `/identifications/compare${queryString({ first: earlier, second: shown })}` : null);
  const others = all.filter((one) => String(one.id) !== shown);
  return (
    <Panel title={t("comparisonWithAnotherIdentification")} aside={<EarlierSelect earlier={earlier} others={others} />}>
      {earlier === "" ? (
        <Empty>{t("chooseOneToCompare")}</Empty>
      ) : (
        <Loaded result={result} lines={12}>
          {(found) => <Changes found={found} estimates={estimates} />}
        </Loaded>
      )}
    </Panel>
  );
}

function EarlierSelect({ earlier, others }: { earlier: string; others: IdentificationSummary[] }) {
  return (
    <label class="switch">
      {t("compareWith")}{" "}
      <select value={earlier} onChange={(event) => replaceQuery({ against: event.currentTarget.value || null })}>
        <option value="">{t("none")}</option>
        {earlier !== "" && !others.some((one) => String(one.id) === earlier) && <option value={earlier}>{earlier}</option>}
        {others.map((one) => (
          <option key={one.id} value={one.id}>
            {one.id} {term(one.run_kind)}, {when(one.measured_at)}
            {one.accepted ? "" : t("notAccepted")}
          </option>
        ))}
      </select>
    </label>
  );
}

function Changes({ found, estimates }: { found: Comparison; estimates: Estimate[] }) {
  const changes = [...found.changes].sort((a, b) => Math.abs(b.sigma ?? 0) - Math.abs(a.sigma ?? 0));
  const elements = [...found.elements].sort((a, b) => a.probability - b.probability);
  return (
    <>
      <p>
        {t("comparisonOfElements", { first: found.first, second: found.second, elements: elements.map((one) => `${elementName(one.element)} ${pValue(one.probability)}`).join(", ") })}
      </p>
      <Scroll label={t("table")}>
        <table class="comparison">
          <thead>
            <tr>
              <th>{t("parameter")}</th>
              <th class="number">{found.first}</th>
              <th class="number">{found.second}</th>
              <th class="number">{t("change")}</th>
              <th class="number">σ</th>
            </tr>
          </thead>
          <tbody>
            {changes.map((one) => (
              <ChangeRow key={one.parameter} one={one} unit={unitOf(one.parameter, estimates)} />
            ))}
          </tbody>
        </table>
      </Scroll>
      {found.only_first.length > 0 && <p class="muted">{t("onlyIn", { first: found.first, parameters: found.only_first.map(parameterName).join(", ") })}</p>}
      {found.only_second.length > 0 && <p class="muted">{t("onlyIn", { first: found.second, parameters: found.only_second.map(parameterName).join(", ") })}</p>}
    </>
  );
}

/** A component of an unbalance has the unit of the unbalance. */
function unitOf(parameter: string, estimates: Estimate[]): string {
  return estimates.find((one) => parameter === one.parameter || parameter.startsWith(`${one.parameter}.`))?.unit ?? "";
}

function valueText(value: number | null, scale: Scale): string {
  return value === null ? t("notDetermined") : `${number(value * scale.factor, 4)} ${scale.unit}`.trim();
}

function ChangeRow({ one, unit }: { one: ComparedChange; unit: string }) {
  const scale = scaleOf(Math.max(Math.abs(one.first ?? 0), Math.abs(one.second ?? 0)), unit, useUnits());
  const isSignificant = Math.abs(one.sigma ?? 0) > SIGNIFICANT;
  return (
    <tr class={isSignificant ? "significant" : undefined}>
      <td>
        {isSignificant && "● "}
        {parameterName(one.parameter)}
      </td>
      <td class="number">{valueText(one.first, scale)}</td>
      <td class="number">{valueText(one.second, scale)}</td>
      <td class="number">{one.per_cent === null ? "–" : percent(one.per_cent / 100)}</td>
      <td class="number">{number(one.sigma, 2)}</td>
    </tr>
  );
}

function pValue(probability: number): string {
  return probability < 1e-6 ? t("below1InAMillion") : `${number(100 * probability, 2)} %`;
}
