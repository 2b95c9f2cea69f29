// Offset and angle of each coupling of a train on oil films, by itself and as changed against the baseline.
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { isComparable } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { number, scaleOf } from "../format/numbers";
import type { Identification } from "../schemas/identifications";
import type { Alignment, AlignmentNumber, AlignmentTarget, Determined } from "../schemas/model";

const QUANTITIES: Record<string, string> = {
  offset_vertical: "Offset, vertical",
  offset_horizontal: "Offset, horizontal",
  angle_vertical: "Angle, vertical",
  angle_horizontal: "Angle, horizontal",
};
const ALIGNMENT = /^coupling\..+\.offset_vertical$/;

/** Nothing where the identification tells of no alignment. */
export function AlignmentPanel({ found }: { found: Identification }) {
  const isShown = isComparable(found) && found.derived.some((one) => ALIGNMENT.test(one.name));
  const result = useResource<Alignment>(isShown ? alignmentPath(found) : null);
  if (!isShown) return null;
  return (
    <Panel title="Alignment of couplings" aside={<p class="muted">driven shaft over the driver's, up and along +x positive; with 95 % intervals</p>}>
      <Loaded result={result} lines={6}>
        {(alignment) => (
          <>
            <p class="muted">{alignment.missing ? `No change against a baseline: ${alignment.missing}.` : baselineText(alignment)}</p>
            <Numbers numbers={alignment.numbers} />
          </>
        )}
      </Loaded>
    </Panel>
  );
}

export function alignmentPath({ id, machine }: Pick<Identification, "id" | "machine">): string {
  return `/machines/${machine}/alignment?identification=${id}`;
}

function baselineText({ baseline }: Alignment): string {
  return `Change: against the baseline of ${baseline.identifications.length} runs. It is known better than the alignment, since what is uncertain of the films is the same in all runs.`;
}

function Numbers({ numbers }: { numbers: AlignmentNumber[] }) {
  const hasTargets = numbers.some((one) => one.target !== null);
  return (
    <Scroll label="Table">
      <table>
        <thead>
          <tr>
            <th>Coupling</th>
            <th>Quantity</th>
            <th class="number">By itself</th>
            <th class="number">Change</th>
            <th class="number">Allowed</th>
            {hasTargets && <th class="number">Off its target</th>}
          </tr>
        </thead>
        <tbody>
          {numbers.map((one) => (
            <tr key={one.name}>
              <td>{one.coupling}</td>
              <th scope="row">{QUANTITIES[one.quantity] ?? one.quantity}</th>
              <Cell told={one.absolute} unit={one.unit} />
              {one.change ? <Cell told={one.change} unit={one.unit} /> : <td class="number">–</td>}
              <td class="number">{allowedText(one)}</td>
              {hasTargets && (one.target ? <TargetCell target={one.target} unit={one.unit} /> : <td class="number">–</td>)}
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

/** What is allowed of the change, and where it is probably more than that, how probably. */
function allowedText({ allowed, beyond, unit }: AlignmentNumber): string {
  if (allowed === null) return "–";
  const scale = scaleOf(allowed, unit);
  const said = `${number(allowed * scale.factor)} ${scale.unit}`;
  return beyond !== null && beyond > 0.5 ? `${said}: exceeded with ${Math.floor(100 * beyond)} %` : said;
}

/** By how much the alignment differs from what is aimed at, hot or cold, and where that is probably too much, how probably. */
function TargetCell({ target: { state, target, off, beyond }, unit }: { target: AlignmentTarget; unit: string }) {
  if (off.value === null) return <td class="number muted">not determined: {off.reason}</td>;
  const scale = scaleOf(Math.max(...[off.value, off.lower, off.upper, target].map((one) => Math.abs(one ?? 0))), unit);
  const shown = (one: number | null) => number(one === null ? null : one * scale.factor);
  const exceeded = beyond !== null && beyond > 0.5 ? `; more than allowed with ${Math.floor(100 * beyond)} %` : "";
  return (
    <td class="number">
      {shown(off.value)} {scale.unit} <small class="muted">{`${shown(off.lower)} … ${shown(off.upper)}; ${state} target ${shown(target)}${exceeded}`}</small>
    </td>
  );
}

function Cell({ told: { value, lower, upper, reason }, unit }: { told: Determined; unit: string }) {
  if (value === null) return <td class="number muted">not determined: {reason}</td>;
  const scale = scaleOf(Math.max(...[value, lower, upper].map((one) => Math.abs(one ?? 0))), unit);
  const shown = (one: number | null) => number(one === null ? null : one * scale.factor);
  return (
    <td class="number">
      {shown(value)} {scale.unit} <small class="muted">{`${shown(lower)} … ${shown(upper)}`}</small>
    </td>
  );
}
