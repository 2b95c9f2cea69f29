// Offset and angle of each coupling of a train on oil films, by itself and as changed against the baseline.
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { isComparable } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { number, scaleOf, type ShownUnits } from "../format/numbers";
import { stored, t, term } from "../messages/messages";
import type { Identification } from "../schemas/identifications";
import type { Alignment, AlignmentNumber, AlignmentTarget, Determined, LoadNumber } from "../schemas/model";

const QUANTITIES: Record<string, string> = {
  offset_vertical: t("offsetVertical"),
  offset_horizontal: t("offsetHorizontal"),
  angle_vertical: t("angleVertical"),
  angle_horizontal: t("angleHorizontal"),
};
const LOADS: Record<string, string> = { load_vertical: t("loadVertical"), load_horizontal: t("loadHorizontal") };
/** The largest chance that is told as a number [%]. */
const MOST_CHANCE = 99;
const ALIGNMENT = /^coupling\..+\.offset_vertical$/;

/** Nothing where the identification tells of no alignment. */
export function AlignmentPanel({ found }: { found: Identification }) {
  const isShown = isComparable(found) && found.derived.some((one) => ALIGNMENT.test(one.name));
  const result = useResource<Alignment>(isShown ? alignmentPath(found) : null);
  if (!isShown) return null;
  return (
    <Panel title={t("alignmentOfCouplings")} aside={<p class="muted">{t("drivenShaftOverTheDriver")}</p>}>
      <Loaded result={result} lines={6}>
        {(alignment) => (
          <>
            <p class="muted">{alignment.missing ? t("noChangeAgainstABaseline", { missing: stored(alignment.missing) }) : baselineText(alignment)}</p>
            <Numbers numbers={alignment.numbers} />
            {alignment.loads.length > 0 && <Loads loads={alignment.loads} />}
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
  return t("changeAgainstBaseline", { runs: baseline.identifications.length });
}

function Numbers({ numbers }: { numbers: AlignmentNumber[] }) {
  const units = useUnits();
  const hasTargets = numbers.some((one) => one.target !== null);
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("coupling")}</th>
            <th>{t("quantity")}</th>
            <th class="number">{t("byItself")}</th>
            <th class="number">{t("change")}</th>
            <th class="number">{t("allowed")}</th>
            {hasTargets && <th class="number">{t("offItsTarget")}</th>}
          </tr>
        </thead>
        <tbody>
          {numbers.map((one) => (
            <tr key={one.name}>
              <td>{one.coupling}</td>
              <th scope="row">{QUANTITIES[one.quantity] ?? one.quantity}</th>
              <DeterminedCell number={one.absolute} unit={one.unit} />
              {one.change ? <DeterminedCell number={one.change} unit={one.unit} /> : <td class="number">–</td>}
              <td class="number">{allowedText(one, units)}</td>
              {hasTargets && (one.target ? <TargetCell target={one.target} unit={one.unit} /> : <td class="number">–</td>)}
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

/** What the bearings carried in the baseline, and by how much that has changed with the alignment. */
function Loads({ loads }: { loads: LoadNumber[] }) {
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("bearing")}</th>
            <th>{t("quantity")}</th>
            <th class="number">{t("before")}</th>
            <th class="number">{t("change")}</th>
          </tr>
        </thead>
        <tbody>
          {loads.map((one) => (
            <tr key={one.name}>
              <td>{one.bearing}</td>
              <th scope="row">{LOADS[one.quantity] ?? one.quantity}</th>
              <td class="number">{number(one.before)} {one.unit}</td>
              <DeterminedCell number={one.change} unit={one.unit} part={one.change_per_cent} />
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

/** What is allowed of the change, and where it is probably more than that, how probably. */
function allowedText({ allowed, beyond, unit }: AlignmentNumber, units: ShownUnits): string {
  if (allowed === null) return "–";
  const scale = scaleOf(allowed, unit, units);
  const limit = `${number(allowed * scale.factor)} ${scale.unit}`;
  return beyond !== null && beyond > 0.5 ? t("allowedExceeded", { allowed: limit, chance: chanceOf(beyond) }) : limit;
}

/** A chance in per cent, of which none is certain. */
function chanceOf(beyond: number): string {
  const part = 100 * beyond;
  return part > MOST_CHANCE ? t("chanceAbove", { per_cent: MOST_CHANCE }) : `${Math.round(part)} %`;
}

/** Difference of the alignment from its target, hot or cold, with the probability that it is too large where it probably is. */
function TargetCell({ target: { state, target, off, beyond }, unit }: { target: AlignmentTarget; unit: string }) {
  const units = useUnits();
  if (off.value === null) return <td class="number muted reason">{t("notDeterminedBecause", { reason: off.reason && stored(off.reason) })}</td>;
  const scale = scaleOf(Math.max(...[off.value, off.lower, off.upper, target].map((one) => Math.abs(one ?? 0))), unit, units);
  const shown = (one: number | null) => number(one === null ? null : one * scale.factor);
  const exceeded = beyond !== null && beyond > 0.5 && `; ${t("targetExceeded", { chance: chanceOf(beyond) })}`;
  return (
    <td class="number">
      {shown(off.value)} {scale.unit} <small class="muted">{`${shown(off.lower)} … ${shown(off.upper)}; `}{t("targetOf", { state: term(state), target: shown(target) })}{exceeded}</small>
    </td>
  );
}

/** part: the number in per cent of what was before; null where that says nothing. */
function DeterminedCell({ number: { value, lower, upper, reason }, unit, part = null }: { number: Determined; unit: string; part?: number | null }) {
  const units = useUnits();
  if (value === null) return <td class="number muted reason">{t("notDeterminedBecause", { reason: reason && stored(reason) })}</td>;
  const scale = scaleOf(Math.max(...[value, lower, upper].map((one) => Math.abs(one ?? 0))), unit, units);
  const shown = (one: number | null) => number(one === null ? null : one * scale.factor);
  return (
    <td class="number">
      {shown(value)} {scale.unit}{part !== null && ` (${number(part)} %)`} <small class="muted">{`${shown(lower)} … ${shown(upper)}`}</small>
    </td>
  );
}
