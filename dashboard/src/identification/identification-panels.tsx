// One identification in numbers and words: how well it fits, each parameter, and what the data do not determine and why.
import type { ComponentChildren } from "preact";
import { link } from "../browser/router";
import { useUnits } from "../browser/units";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { angleConvention, angleText } from "../format/angles";
import { elementName, isCrossCoupled, isUnbalance, parameterName, quantityName } from "../format/names";
import { number, quantity, scaleOf } from "../format/numbers";
import { rich, stored, t, term } from "../messages/messages";
import type { Estimate, Identification } from "../schemas/identifications";
import type { Document } from "../schemas/machines";
import { elementsOfEstimates } from "../words/elements";

/** Half an interval over the value: up to the first a parameter is known well, beyond the second poorly. */
const GOOD = 0.1;
const POOR = 0.5;

export function IdentificationPanels({ machine, found }: { machine: Document; found: Identification }) {
  const hasUnbalance = found.estimates.some((one) => isUnbalance(one.parameter));
  return (
    <>
      <div class="columns">
        <FitPanel machine={machine} found={found} />
        <IdentifiabilityPanel found={found} />
      </div>
      <Panel
        title={t("parametersWith95Intervals")}
        aside={hasUnbalance && <p class="muted">{t("anglesOfUnbalances", { convention: angleConvention(machine.rotation) })}</p>}
      >
        <div class="elements">
          {elementsOfEstimates(found.estimates).map((element) => (
            <ElementTable key={element} machine={machine.id} element={element} estimates={found.estimates.filter((one) => one.element === element)} />
          ))}
        </div>
      </Panel>
    </>
  );
}

function FitPanel({ machine, found }: { machine: Document; found: Identification }) {
  const { length } = useUnits();
  return (
    <Panel title={t("fit")}>
      <p class={found.accepted ? undefined : "error"}>{stored(found.verdict, length)}</p>
      <dl class="facts">
        <Fact name={t("measured")}>
          <Time at={found.measured_at} />, {term(found.run_kind)},{" "}
          {found.runs.map((run) => (
            <a key={run} href={link(["machines", machine.id, "response"], { run: String(run) })}>
              {t("runNumber", { run })}{" "}
            </a>
          ))}
        </Fact>
        <Fact name={t("data")}>
          {rich("samplesBetween", { samples: found.samples, low: <Speed rpm={found.speed_minimum_rpm} />, high: <Speed rpm={found.speed_maximum_rpm} /> })}
        </Fact>
        <Fact name={t("freedom")}>
          {number(found.chi_square / found.degrees_of_freedom)} ({number(found.chi_square, 5)} / {found.degrees_of_freedom})
        </Fact>
        <Fact name={t("conditionNumber")}>{number(found.condition_number)}</Fact>
        <Fact name={t("computed")}>
          {rich("timeByVersion", { time: <Time at={found.computed_at} />, version: found.code_version })}
        </Fact>
      </dl>
    </Panel>
  );
}

function Fact({ name, children }: { name: string; children: ComponentChildren }) {
  return (
    <>
      <dt>{name}</dt>
      <dd>{children}</dd>
    </>
  );
}

/** Half the interval over the value; null where there is none. */
function relativeHalfWidth(one: Estimate): number | null {
  if (one.value === null || one.lower === null || one.upper === null) return null;
  const size = one.imaginary === null ? Math.abs(one.value) : Math.hypot(one.value, one.imaginary);
  return size > 0 ? (one.upper - one.lower) / 2 / size : null;
}

/** Cross-coupled terms may be near zero: the relative width of their intervals says nothing against them. */
function isDirect(one: Estimate): boolean {
  return one.imaginary !== null || !isCrossCoupled(one.parameter);
}

function IdentifiabilityPanel({ found }: { found: Identification }) {
  const known = found.estimates.filter((one) => one.value !== null);
  const direct = known.filter(isDirect);
  const good = direct.filter((one) => (relativeHalfWidth(one) ?? Infinity) <= GOOD);
  const poor = direct.filter((one) => (relativeHalfWidth(one) ?? 0) > POOR);
  const missing = found.estimates.filter((one) => one.value === null);
  return (
    <Panel title={t("identifiability")}>
      <p>
        {t("determinedOf", { determined: known.length, all: found.estimates.length, direct: direct.length, good: good.length, limit: 100 * GOOD, wide: poor.length > 0 ? t("wideIntervals", { count: poor.length, limit: 100 * POOR, names: poor.map((one) => parameterName(one.parameter)).join(", ") }) : "." })}
      </p>
      {missing.length === 0 ? (
        <Empty>{t("allParametersAreDetermined")}</Empty>
      ) : (
        <>
          <p>{t("notEstimableFromThisRun")}</p>
          <ul class="reasons">
            {missing.map((one) => (
              <li key={one.parameter}>
                <strong>{parameterName(one.parameter)}</strong>: {stored(one.reason ?? "")}
              </li>
            ))}
          </ul>
        </>
      )}
    </Panel>
  );
}

function ElementTable({ machine, element, estimates }: { machine: string; element: string; estimates: Estimate[] }) {
  return (
    <section>
      <h3>
        <a href={link(["machines", machine, "trends"], { element })}>{elementName(element)}</a>
      </h3>
      <Scroll label={t("table")}>
        <table>
          <tbody>
            {estimates.map((one) => (
              <EstimateRow key={one.parameter} one={one} />
            ))}
          </tbody>
        </table>
      </Scroll>
    </section>
  );
}

function EstimateRow({ one }: { one: Estimate }) {
  const units = useUnits();
  if (one.value === null) {
    return (
      <tr>
        <td>{quantityName(one.parameter)}</td>
        <td colSpan={3} class="muted" title={one.reason ? stored(one.reason) : undefined}>
          {t("notEstimable")}
        </td>
      </tr>
    );
  }
  const size = one.imaginary === null ? one.value : Math.hypot(one.value, one.imaginary);
  const scale = scaleOf(size, one.unit, units);
  const angle = angleText(one.angle_deg, one.angle_half_width_deg);
  return (
    <tr title={t("standardError", { error: quantity(one.standard_error, one.unit, units) })}>
      <td>{quantityName(one.parameter)}</td>
      <td class="number">
        {number(size * scale.factor)} {scale.unit}
        {angle && <small>{angle.trim()}</small>}
      </td>
      <td class="number muted">
        {one.lower === null ? "–" : number(one.lower * scale.factor)} … {one.upper === null ? "–" : number(one.upper * scale.factor)}
      </td>
      <td>
        <WidthBar part={relativeHalfWidth(one)} />
      </td>
    </tr>
  );
}

/** The width of an interval as a bar: full at 100 % of the value. */
function WidthBar({ part }: { part: number | null }) {
  if (part === null) return null;
  return (
    <span class="bar-of" role="img" aria-label={t("intervalHalf", { half: number(100 * part, 2) })} title={`± ${number(100 * part, 2)} %`}>
      <span style={{ width: `${Math.min(100, 100 * part)}%` }} />
    </span>
  );
}
