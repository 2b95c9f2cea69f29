// One identification in numbers and words: how well it fits, what each parameter is, what the data do not tell and why.
import { useEffect } from "preact/hooks";
import type { Document, Estimate, Identification, IdentificationSummary } from "../schemas/answers";
import { angleWords } from "../panels/angle-history";
import { ComparisonPanel } from "../panels/comparison-panel";
import { CorrelationPanel } from "../panels/correlation-panel";
import { angleSense, elementName, isCrossCoupled, isUnbalance, number, quantity, rpm, scaleOf, termName, when } from "../words/format";
import { Cut, Empty, Panel, Shown, Time } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, link, place } from "../browser/router";
import { useStore } from "../browser/store";
import { elementsOf, NotIdentified } from "../data/newest-identification";

/** An interval wider than this part of the value says little. */
const POOR = 0.5;
const FAIR = 0.1;
const SHOWN = 200;

export function IdentifiedView({ machine }: { machine: Document }) {
  const { query } = useStore(place);
  const list = useResource<IdentificationSummary[]>(`/machines/${machine.id}/identifications?limit=${SHOWN}`, 15_000);
  const asked = query.get("identification") ?? String(list.data?.find((one) => one.accepted && one.scope === "run")?.id ?? list.data?.[0]?.id ?? "");
  const answer = useResource<Identification>(asked ? `/identifications/${asked}` : null);
  useEffect(() => {
    if (asked && !query.get("identification")) choose({ identification: asked });
  }, [asked, query]);
  if (list.data?.length === 0) return <NotIdentified />;
  return (
    <>
      <Panel title="What is shown">
        <div class="choices">
          <label>
            Identification
            <select value={asked} onChange={(event) => choose({ identification: event.currentTarget.value })}>
              {list.data && !list.data.some((one) => String(one.id) === asked) && <option value={asked}>{asked}</option>}
              {list.data?.map((one) => (
                <option key={one.id} value={one.id}>
                  {one.id} {one.run_kind}, {when(one.measured_at)}
                  {one.scope === "run" ? "" : `, ${one.scope}`}
                  {one.accepted ? "" : ", not accepted"}
                </option>
              ))}
            </select>
          </label>
          <Cut shown={list.data?.length ?? 0} most={SHOWN} />
        </div>
      </Panel>
      <Shown answer={answer} lines={30}>
        {(found) =>
          found.machine === machine.id ? (
            <Identified machine={machine} found={found} />
          ) : (
            <Empty>Identification {found.id} is of another machine: {found.machine}.</Empty>
          )
        }
      </Shown>
      {asked && <ComparisonPanel shown={asked} all={list.data ?? []} estimates={answer.data?.estimates ?? []} />}
      {asked && <CorrelationPanel identification={asked} />}
    </>
  );
}

export function Identified({ machine, found }: { machine: Document; found: Identification }) {
  return (
    <>
      <div class="columns">
        <Fit machine={machine} found={found} />
        <Words found={found} />
      </div>
      <Panel
        title="Parameters, with 95 % intervals"
        aside={found.estimates.some((one) => isUnbalance(one.parameter)) && <p class="muted">Angles of unbalances: {angleSense(machine.rotation)}</p>}
      >
        <div class="elements">
          {elementsOf(found.estimates).map((element) => (
            <Element key={element} machine={machine.id} element={element} estimates={found.estimates.filter((one) => one.element === element)} />
          ))}
        </div>
      </Panel>
    </>
  );
}

function Fit({ machine, found }: { machine: Document; found: Identification }) {
  return (
    <Panel title="The fit">
      <p class={found.accepted ? undefined : "trouble"}>{found.verdict}</p>
      <dl class="facts">
        <dt>Measured</dt>
        <dd>
          <Time at={found.measured_at} />, {found.run_kind},{" "}
          {found.runs.map((run) => (
            <a key={run} href={link(["machines", machine.id, "response"], { run: String(run) })}>
              run {run}{" "}
            </a>
          ))}
        </dd>
        <dt>Data</dt>
        <dd>
          {found.samples} samples, {rpm(found.speed_minimum_rpm)} to {rpm(found.speed_maximum_rpm)}
        </dd>
        <dt>χ² over degrees of freedom</dt>
        <dd>
          {number(found.chi_square / found.degrees_of_freedom)} ({number(found.chi_square, 5)} / {found.degrees_of_freedom})
        </dd>
        <dt>Condition number</dt>
        <dd>{number(found.condition_number)}</dd>
        <dt>Computed</dt>
        <dd>
          <Time at={found.computed_at} /> by version {found.code_version}
        </dd>
      </dl>
    </Panel>
  );
}

/** Half the interval over the value; null where there is none. */
function width(one: Estimate): number | null {
  if (one.value === null || one.lower === null || one.upper === null) return null;
  const size = one.imaginary === null ? Math.abs(one.value) : Math.hypot(one.value, one.imaginary);
  return size > 0 ? (one.upper - one.lower) / 2 / size : null;
}

/** Cross-coupled terms may be anywhere near zero: their interval says nothing against them. */
function isDirect(one: Estimate): boolean {
  return one.imaginary !== null || !isCrossCoupled(one.parameter);
}

function Words({ found }: { found: Identification }) {
  const known = found.estimates.filter((one) => one.value !== null);
  const direct = known.filter(isDirect);
  const sharp = direct.filter((one) => (width(one) ?? Infinity) <= FAIR);
  const vague = direct.filter((one) => (width(one) ?? 0) > POOR);
  const missing = found.estimates.filter((one) => one.value === null);
  return (
    <Panel title="What the data tell">
      <p>
        {known.length} of {found.estimates.length} parameters are determined. Of the {direct.length} direct terms and unbalances among them,{" "}
        {sharp.length} are known to ± {100 * FAIR} % or better
        {vague.length > 0 ? `, and of ${vague.length} the 95 % interval is wider than ± ${100 * POOR} %: ${vague.map((one) => one.parameter).join(", ")}.` : "."}
      </p>
      {missing.length === 0 ? (
        <Empty>Nothing is left undetermined.</Empty>
      ) : (
        <>
          <p>Not estimable from this run:</p>
          <ul class="reasons">
            {missing.map((one) => (
              <li key={one.parameter}>
                <strong>{one.parameter}</strong>: {one.reason}
              </li>
            ))}
          </ul>
        </>
      )}
    </Panel>
  );
}

function Element({ machine, element, estimates }: { machine: string; element: string; estimates: Estimate[] }) {
  return (
    <section>
      <h3>
        <a href={link(["machines", machine, "trends"], { element })}>{elementName(element)}</a>
      </h3>
      <div class="scroll">
        <table>
          <tbody>
            {estimates.map((one) => (
              <Row key={one.parameter} one={one} />
            ))}
          </tbody>
        </table>
      </div>
    </section>
  );
}

function Row({ one }: { one: Estimate }) {
  if (one.value === null) {
    return (
      <tr>
        <td>{termName(one.parameter)}</td>
        <td colSpan={3} class="muted" title={one.reason ?? undefined}>
          not estimable
        </td>
      </tr>
    );
  }
  const size = one.imaginary === null ? one.value : Math.hypot(one.value, one.imaginary);
  const scale = scaleOf(size, one.unit);
  const part = width(one);
  const angle = angleWords(one.angle_deg, one.angle_half_width_deg);
  return (
    <tr title={`standard error ${quantity(one.standard_error, one.unit)}`}>
      <td>{termName(one.parameter)}</td>
      <td class="number">
        {number(size * scale.factor)} {scale.unit}
        {angle && <small>{angle.trim()}</small>}
      </td>
      <td class="number muted">
        {one.lower === null ? "–" : number(one.lower * scale.factor)} … {one.upper === null ? "–" : number(one.upper * scale.factor)}
      </td>
      <td>
        <Bar part={part} />
      </td>
    </tr>
  );
}

/** How wide the interval is, as a length: full at 100 % of the value. */
function Bar({ part }: { part: number | null }) {
  if (part === null) return null;
  return (
    <span class="bar-of" role="img" aria-label={`interval ± ${number(100 * part, 2)} %`} title={`± ${number(100 * part, 2)} %`}>
      <span style={{ width: `${Math.min(100, 100 * part)}%` }} />
    </span>
  );
}
