// Field balancing beside the machine: the newest one's steps, correction, promise, check run and vectors, on one printed page.
import { useState } from "preact/hooks";
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { useSpeedText } from "../components/speed";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { BalancingDialog, WithdrawTrialDialog, type BalancingStep } from "../dialogs/balancing-dialogs";
import { angleConvention, angleText } from "../format/angles";
import { number } from "../format/numbers";
import { rich, stored, t, term } from "../messages/messages";
import type { CheckRun, FieldBalancing, ProposedCorrection, Residual, Weight } from "../schemas/balancings";
import type { Document } from "../schemas/machines";
import { BalancingVectors } from "./balancing-vectors";

const STEPS: Record<FieldBalancing["state"], [step: BalancingStep, name: string][]> = {
  begun: [["trial", t("addATrialRunDots")]],
  tried: [["trial", t("addATrialRunDots")], ["correction", t("computeTheCorrectionDots")]],
  proposed: [["correction", t("computeAnew")], ["check", t("compareACheckRunDots")]],
  checked: [["check", t("compareAnotherCheckRun")], ["correction", t("computeAnew")]],
};

interface Props {
  machine: Document;
  /** Out of sight; a step that is being entered stays. */
  hidden?: boolean;
  /** What speaks against balancing now; null for nothing. */
  warning?: string | null;
}

/** The step that is being entered, of the balancing that was shown when it was opened. */
interface OpenStep {
  step: BalancingStep;
  of: FieldBalancing | null;
}

export function FieldBalancingPanel({ machine, hidden = false, warning = null }: Props) {
  const [open, setOpen] = useState<OpenStep | null>(null);
  const [withdrawing, setWithdrawing] = useState<{ run: number; of: FieldBalancing } | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  /** The one that a step was stored to last: shown until the list has it. */
  const [latest, setLatest] = useState<FieldBalancing | null>(null);
  const result = useResource<FieldBalancing[]>(`/machines/${machine.id}/balancings`, 30_000);
  const shown = result.data?.find((one) => one.id === chosen) ?? (latest?.id === chosen ? latest : undefined) ?? result.data?.[0];
  const onStored = (stored: FieldBalancing) => {
    setLatest(stored);
    setChosen(stored.id);
  };
  return (
    <>
      <div hidden={hidden}>
        <Panel title={t("fieldBalancing")} aside={<PanelButtons isShown={!!shown} onBegin={() => setOpen({ step: "begin", of: null })} />}>
          <Loaded result={result} lines={6}>
            {(list) =>
              shown ? (
                <>
                  {list.length > 1 && <BalancingSelect list={list} shown={shown} onChoose={setChosen} />}
                  <Steps found={shown} onStep={(step) => setOpen({ step, of: shown })} onWithdraw={(run) => setWithdrawing({ run, of: shown })} />
                  {shown.correction && <Correction found={shown.correction} check={shown.check} angles={scaleWords(shown, machine)} />}
                  {shown.check && <Check found={shown.check} />}
                  {shown.correction && <BalancingVectors correction={shown.correction} check={shown.check} />}
                </>
              ) : (
                <Empty>{t("noBalancingYet")}</Empty>
              )
            }
          </Loaded>
        </Panel>
      </div>
      {open && (
        <BalancingDialog machine={machine} step={open.step} balancing={open.of} warning={warning} onStored={onStored} onClose={() => setOpen(null)} />
      )}
      {withdrawing && <WithdrawTrialDialog balancing={withdrawing.of} run={withdrawing.run} onStored={onStored} onClose={() => setWithdrawing(null)} />}
    </>
  );
}

function PanelButtons({ isShown, onBegin }: { isShown: boolean; onBegin: () => void }) {
  return (
    <span class="screen">
      <button type="button" onClick={onBegin}>
        {t("beginDots")}
      </button>{" "}
      {isShown && (
        <button type="button" onClick={() => window.print()}>
          {t("print")}
        </button>
      )}
    </span>
  );
}

function BalancingSelect({ list, shown, onChoose }: { list: FieldBalancing[]; shown: FieldBalancing; onChoose: (id: number) => void }) {
  return (
    <label class="screen">
      {t("balancing")}{" "}
      <select value={shown.id} onChange={(event) => onChoose(Number(event.currentTarget.value))}>
        {list.map((one) => (
          <option key={one.id} value={one.id}>{`${one.id}, ${term(one.state)}`}</option>
        ))}
      </select>
    </label>
  );
}

interface StepsProps {
  found: FieldBalancing;
  onStep: (step: BalancingStep) => void;
  onWithdraw: (run: number) => void;
}

function Steps({ found, onStep, onWithdraw }: StepsProps) {
  return (
    <>
      <p class="muted">
        {rich("balancingBegun", { id: found.id, time: <Time at={found.created_at} />, by: found.by, comment: found.comment && `: ${found.comment}` })}
      </p>
      <ul>
        <li>{t("initialRun", { runs: found.initial.join(", ") })}</li>
        {found.trials.map((one) => (
          <li key={one.run}>
            {t("trialRun", { run: one.run, weights: weightsText(one.weights) })}{" "}
            <button type="button" class="screen" aria-label={t("withdrawTrialRun", { run: one.run })} onClick={() => onWithdraw(one.run)}>
              {t("withdrawDots")}
            </button>
          </li>
        ))}
        {found.withdrawn.map((one) => (
          <li key={`${one.run} ${one.at}`} class="muted">
            {rich("trialRunWithdrawn", { run: one.run, weights: weightsText(one.weights), time: <Time at={one.at} />, by: one.withdrawn_by, why: one.comment })}
          </li>
        ))}
      </ul>
      <p class="buttons">
        {STEPS[found.state].map(([step, name]) => (
          <button key={step} type="button" onClick={() => onStep(step)}>
            {name}
          </button>
        ))}
      </p>
    </>
  );
}

/** How angles on the discs are counted, as a column's heading says it. */
function scaleWords(found: FieldBalancing, machine: Document): string {
  const { counted, zero_deg } = found.disc_scale;
  if (counted === "x-to-y" && zero_deg === 0) return angleConvention(machine.rotation);
  const sense = { "x-to-y": t("fromXTowardsY"), "with-rotation": t("withTheRotation"), "against-rotation": t("againstTheRotation") }[counted];
  return t("onTheDiscSScale", { sense });
}

function Correction({ found, check, angles }: { found: ProposedCorrection; check: CheckRun | null; angles: string }) {
  return (
    <>
      <p>{stored(found.influence)}</p>
      {found.notes.map((one) => (
        <p key={one} class="notice">
          {stored(one)}
        </p>
      ))}
      <div class="columns">
        <Scroll label={t("table")}>
          <table>
            <thead>
              <tr>
                <th>{t("disc")}</th>
                <th class="number">{t("add")}</th>
                <th>{t("angleCounted", { convention: angles })}</th>
                <th>{t("masses")}</th>
              </tr>
            </thead>
            <tbody>
              {found.planes.map((one) => (
                <tr key={one.disc}>
                  <td>{one.disc}</td>
                  <td class="number" title={t("toGMm95", { lower: number(one.lower_g_mm), upper: number(one.upper_g_mm) })}>
                    {number(one.g_mm)} g·mm
                  </td>
                  <td>{angleText(one.scale_deg, one.half_width_deg)}</td>
                  <td>{one.masses.map((mass) => t("massAtAngle", { grams: number(mass.grams), angle: Math.round(mass.scale_deg) })).join(", ")}</td>
                </tr>
              ))}
            </tbody>
          </table>
          <p class="muted">{t("countedFromTheStateWithout")}</p>
        </Scroll>
        <Channels found={found} check={check} />
      </div>
      <ResidualUnbalances found={found} check={check} />
    </>
  );
}

function Channels({ found, check }: { found: ProposedCorrection; check: CheckRun | null }) {
  const { amplitude } = useUnits();
  const amplitudeText = (um: number | null | undefined) => (um === null || um === undefined ? "–" : `${number(um * amplitude.factor)} ${amplitude.label}`);
  const measured = (channel: string) => check?.channels.find((one) => one.channel === channel);
  const others = check !== null && hasOtherWeights(check);
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("channel")}</th>
            <th class="number">{t("largestBefore")}</th>
            <th class="number">{t("promised95")}</th>
            {others && <th class="number">{t("predictedForWeightsOn")}</th>}
            {check && <th class="number">{t("checkRun")}</th>}
          </tr>
        </thead>
        <tbody>
          {found.channels.map((one) => (
            <tr key={one.channel}>
              <td>{one.channel}</td>
              <td class="number">{amplitudeText(one.before_um_pp)}</td>
              <td class="number">{t("belowAmplitude", { upper: amplitudeText(one.upper_um_pp) })}</td>
              {others && <td class="number">{t("belowAmplitude", { upper: amplitudeText(measured(one.channel)?.upper_um_pp) })}</td>}
              {check && (
                <td class="number">
                  {amplitudeText(measured(one.channel)?.check_um_pp)}{measured(one.channel)?.kept === false && t(others ? "moreThanPredicted" : "moreThanPromised")}
                </td>
              )}
            </tr>
          ))}
        </tbody>
      </table>
      {found.limit_um_pp !== null && (
        <p>
          {t("limitOfDocument", { limit: amplitudeText(found.limit_um_pp), verdict: stored(found.limit_verdict ?? ""), check: check && check.limit_met !== null && t("byTheCheckRun", { verdict: check.limit_met ? t("met") : t("notMet") }) })}
        </p>
      )}
    </Scroll>
  );
}

function ResidualUnbalances({ found, check }: { found: ProposedCorrection; check: CheckRun | null }) {
  const speedText = useSpeedText();
  return (
    <Scroll label={t("table")}>
      <h3>
        {t("residualAsOfRigid", { grade: number(found.grade), speed: speedText(found.service_rpm) })}
      </h3>
      <table>
        <thead>
          <tr>
            <th>{t("plane")}</th>
            <th class="number">{t("permissible")}</th>
            <th class="number">{t("before")}</th>
            <th class="number">{t("predictedAfter")}</th>
            {check && <th class="number">{t("checkRun")}</th>}
          </tr>
        </thead>
        <tbody>
          {found.residual.map((one, at) => (
            <tr key={one.bearing}>
              <td>
                {one.shaft}, {one.bearing}
              </td>
              <td class="number">{number(one.permissible_g_mm)} g·mm</td>
              <td class="number">{residualText(one.before)}</td>
              <td class="number">{residualText(one.after)}</td>
              {check && <td class="number">{check.residual[at] && residualText(check.residual[at])}</td>}
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function residualText(one: Residual): string {
  if (one.g_mm === null || one.upper_g_mm === null) return t("residualUntold", { why: stored(one.untold) });
  return t("residualVerdict", { amount: number(one.g_mm), upper: number(one.upper_g_mm), verdict: stored(one.verdict) });
}

function weightsText(weights: Weight[]): string {
  return weights.map((one) => t("weightOnDisc", { amount: number(one.g_mm), disc: one.disc, angle: Math.round(one.scale_deg) })).join(", ") || t("noneOn");
}

/** Whether the promise of the correction is not for the weights that were on; of an older release by whether any were stated. */
function hasOtherWeights(check: CheckRun): boolean {
  return check.other_weights ?? check.weights !== null;
}

function Check({ found }: { found: CheckRun }) {
  const { points_kept: kept, points, unpredicted } = found;
  const within = unpredicted.length > 0 ? t("nothingPredictedFor", { discs: unpredicted.join(", ") }) : t("pointsWithinThePrediction", { kept, points });
  const trim = found.trim_is_noise ? t("nothingToTrim") : t("toTrimAdd", { weights: weightsText(found.trim) });
  return (
    <p>
      {hasOtherWeights(found) && `${t("otherWeightsWereOn")} `}
      {rich("checkRunText", { run: found.run, time: <Time at={found.at} />, by: found.by, on: found.weights === null ? t("withTheWeightsProposed") : t("withWeights", { weights: weightsText(found.weights) }), kept: within, trim })}
    </p>
  );
}
