// What changed from an earlier identification to the one that is shown.
import type { Comparison, ComparedChange, Estimate, IdentificationSummary } from "../schemas/answers";
import { query } from "../data/http-client";
import { elementName, number, percent, scaleOf, when, type Scale } from "../words/format";
import { Empty, Panel, Shown } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, place } from "../browser/router";
import { useStore } from "../browser/store";

/** A change larger than this many standard errors stands out. */
const CLEAR = 3;

interface Props {
  shown: string;
  all: IdentificationSummary[];
  /** Of the identification that is shown: they tell the units. */
  estimates: Estimate[];
}

export function ComparisonPanel({ shown, all, estimates }: Props) {
  const { query: chosen } = useStore(place);
  const others = all.filter((one) => String(one.id) !== shown);
  const earlier = chosen.get("against") ?? "";
  const answer = useResource<Comparison>(earlier ? `/identifications/compare${query({ first: earlier, second: shown })}` : null);
  return (
    <Panel
      title="What changed against another identification"
      aside={
        <label class="switch">
          Against{" "}
          <select value={earlier} onChange={(event) => choose({ against: event.currentTarget.value || null })}>
            <option value="">none</option>
            {earlier !== "" && !others.some((one) => String(one.id) === earlier) && <option value={earlier}>{earlier}</option>}
            {others.map((one) => (
              <option key={one.id} value={one.id}>
                {one.id} {one.run_kind}, {when(one.measured_at)}
                {one.accepted ? "" : ", not accepted"}
              </option>
            ))}
          </select>
        </label>
      }
    >
      {earlier === "" ? (
        <Empty>Choose one: each parameter's change is shown in per cent, and in standard errors of both fits.</Empty>
      ) : (
        <Shown answer={answer} lines={12}>
          {(found) => <Changes found={found} estimates={estimates} />}
        </Shown>
      )}
    </Panel>
  );
}

function Changes({ found, estimates }: { found: Comparison; estimates: Estimate[] }) {
  const changes = [...found.changes].sort((a, b) => Math.abs(b.sigma ?? 0) - Math.abs(a.sigma ?? 0));
  return (
    <>
      <p>
        From identification {found.first} to {found.second}, elements by how unlikely such a change is by the fits' errors alone:{" "}
        {[...found.elements]
          .sort((a, b) => a.probability - b.probability)
          .map((one) => `${elementName(one.element)} ${chance(one.probability)}`)
          .join(", ")}
        .
      </p>
      <div class="scroll">
        <table class="comparison">
          <thead>
            <tr>
              <th>Parameter</th>
              <th class="number">{found.first}</th>
              <th class="number">{found.second}</th>
              <th class="number">Change</th>
              <th class="number">σ</th>
            </tr>
          </thead>
          <tbody>
            {changes.map((one) => (
              <Row key={one.parameter} one={one} unit={unitOf(one.parameter, estimates)} />
            ))}
          </tbody>
        </table>
      </div>
      {found.only_first.length > 0 && <p class="muted">Only in {found.first}: {found.only_first.join(", ")}.</p>}
      {found.only_second.length > 0 && <p class="muted">Only in {found.second}: {found.only_second.join(", ")}.</p>}
    </>
  );
}

/** A component of an unbalance has its unit. */
function unitOf(parameter: string, estimates: Estimate[]): string {
  return estimates.find((one) => parameter === one.parameter || parameter.startsWith(`${one.parameter}.`))?.unit ?? "";
}

function written(value: number | null, scale: Scale): string {
  return value === null ? "not determined" : `${number(value * scale.factor, 4)} ${scale.unit}`.trim();
}

function Row({ one, unit }: { one: ComparedChange; unit: string }) {
  const scale = scaleOf(Math.max(Math.abs(one.first ?? 0), Math.abs(one.second ?? 0)), unit);
  const clear = Math.abs(one.sigma ?? 0) > CLEAR;
  return (
    <tr class={clear ? "clear" : undefined}>
      <td>
        {clear && "● "}
        {one.parameter}
      </td>
      <td class="number">{written(one.first, scale)}</td>
      <td class="number">{written(one.second, scale)}</td>
      <td class="number">{one.per_cent === null ? "–" : percent(one.per_cent / 100)}</td>
      <td class="number">{number(one.sigma, 2)}</td>
    </tr>
  );
}

function chance(probability: number): string {
  return probability < 1e-6 ? "below 1 in a million" : `${number(100 * probability, 2)} %`;
}
