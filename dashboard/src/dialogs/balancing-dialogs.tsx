// The steps of a field balancing: begin with an initial run, add a trial run, compute the correction, compare a check run.
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch, useResource } from "../data/resource";
import { isDwells } from "../data/run-selection";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import type { FieldBalancing, Weight } from "../schemas/balancings";
import type { Document } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import { author, CommentField, FormDialog } from "./form-dialog";

const RUNS = 50;
const UNITS = ["g mm", "g", "kg mm", "kg", "oz in", "oz", "g in"];
const MASSES = ["g", "kg", "oz"];

export type BalancingStep = "begin" | "trial" | "correction" | "check";

interface Props {
  machine: Document;
  step: BalancingStep;
  /** The balancing that goes on; null to begin one. */
  balancing: FieldBalancing | null;
  /** What speaks against it now; null for nothing. */
  warning: string | null;
  /** Called with the balancing as it is after the step. */
  onStored: (balancing: FieldBalancing) => void;
  onClose: () => void;
}

const TITLES: Record<BalancingStep, [title: string, button: string]> = {
  begin: [t("beginAFieldBalancing"), t("begin")],
  trial: [t("addATrialRun"), t("add")],
  correction: [t("computeTheCorrection"), t("compute")],
  check: [t("compareACheckRun"), t("compare")],
};

export function BalancingDialog({ machine, step, balancing, warning, onStored, onClose }: Props) {
  const [title, button] = TITLES[step];
  const list = `/machines/${machine.id}/balancings`;
  const discs = machine.discs.map((one) => one.id);
  const last = balancing?.trials.at(-1);
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const path = { begin: list, trial: `${list}/${balancing?.id}/trials`, correction: `${list}/${balancing?.id}/correction`, check: `${list}/${balancing?.id}/check` }[step];
    try {
      onStored(await post<FieldBalancing>(path, bodyOf(step, form, discs, balancing), null, keys));
      await refetch(list); // the next step is of what is shown
    } catch (error) {
      void refetch(list);
      throw error;
    }
  };
  return (
    <FormDialog title={title} button={button} onSubmit={submit} onClose={onClose}>
      <p class={warning ? "error" : undefined} role="status">
        {warning}
      </p>
      {step === "begin" && <RunField machine={machine.id} label={t("runWithoutTrialWeights")} />}
      {step === "begin" && <ScaleFields />}
      {step === "begin" && <CommentField />}
      {step === "trial" && <RunField machine={machine.id} label={t("runWithTheWeight")} />}
      {step === "trial" && <WeightFields machine={machine} />}
      {step === "trial" && last && <KeptField trial={last} />}
      {step === "correction" && <CorrectionFields machine={machine} />}
      {step === "check" && <RunField machine={machine.id} label={t("checkRun")} />}
      {step === "check" && <InstalledFields discs={discs} trimmed={balancing?.check != null} />}
    </FormDialog>
  );
}

function bodyOf(step: BalancingStep, form: FormData, discs: string[], balancing: FieldBalancing | null): unknown {
  const by = author(form);
  const run = Number(form.get("run"));
  switch (step) {
    case "begin":
      return { runs: [run], disc_scale: { counted: form.get("counted"), zero_deg: Number(form.get("zero")) }, comment: form.get("comment") ?? "", by };
    case "trial": {
      const unit = String(form.get("unit"));
      const radius = MASSES.includes(unit) ? { radius_mm: Number(form.get("radius")) } : {};
      const weight = { disc: form.get("disc"), amount: Number(form.get("amount")), unit, angle_deg: Number(form.get("angle")), ...radius };
      const kept = form.get("kept") ? (balancing?.trials.at(-1)?.weights ?? []).map(stated) : [];
      return { run, weights: [...kept, weight], by };
    }
    case "correction":
      return { criterion: form.get("criterion"), grade: Number(form.get("grade")), speeds_rpm: speedsOf(form), limits_g_mm: limitsOf(form, discs), places: placesOf(form, discs), by };
    case "check":
      return { run, weights: installedOf(form, discs, balancing), by };
  }
}

/** The speeds that were stated [r/min]; null for none. */
function speedsOf(form: FormData): number[] | null {
  const stated = String(form.get("speeds") ?? "").match(/[^\s;]+/g);
  return stated ? stated.map((one) => Number(one.replace(",", "."))) : null;
}

/** A weight of an answer as a request states it. */
function stated(weight: Weight): unknown {
  return { disc: weight.disc, amount: weight.g_mm, unit: "g mm", angle_deg: weight.scale_deg };
}

/** All that is on during a check run; null for the proposed weights. */
function installedOf(form: FormData, discs: string[], balancing: FieldBalancing | null): unknown[] | null {
  switch (form.get("installed")) {
    case "trimmed": {
      const before = balancing?.check?.weights ?? balancing?.correction?.planes ?? [];
      return [...before, ...(balancing?.check?.trim ?? [])].filter((one) => one.g_mm > 0).map(stated);
    }
    case "others":
      return discs
        .filter((disc) => Number(form.get(`on ${disc}`)) > 0)
        .map((disc) => ({ disc, amount: Number(form.get(`on ${disc}`)), unit: "g mm", angle_deg: Number(form.get(`at ${disc}`)) }));
    default:
      return null;
  }
}

/** Largest corrections of the discs for which one is given. */
function limitsOf(form: FormData, discs: string[]): Record<string, number> {
  return Object.fromEntries(discs.filter((disc) => form.get(`limit ${disc}`)).map((disc) => [disc, Number(form.get(`limit ${disc}`))]));
}

/** Holes of the discs for which a number of them is given. */
function placesOf(form: FormData, discs: string[]): Record<string, unknown> {
  const given = discs.filter((disc) => form.get(`count ${disc}`));
  const optional = (name: string) => (form.get(name) ? Number(form.get(name)) : null);
  return Object.fromEntries(
    given.map((disc) => [
      disc,
      {
        count: Number(form.get(`count ${disc}`)),
        radius_mm: Number(form.get(`radius ${disc}`)),
        first_deg: optional(`first ${disc}`) ?? 0,
        largest_g: optional(`largest ${disc}`),
        step_g: optional(`step ${disc}`),
      },
    ]),
  );
}

function ScaleFields() {
  return (
    <>
      <label>
        {t("theDiscsScaleOfAngles")}
        <select name="counted">
          <option value="x-to-y">{t("fromXTowardsY")}</option>
          <option value="with-rotation">{t("withTheRotation")}</option>
          <option value="against-rotation">{t("againstTheRotation")}</option>
        </select>
      </label>
      <label>
        {t("whereItsZeroIsAt")}
        <input name="zero" type="number" step="any" min="-360" max="360" defaultValue="0" required />
      </label>
    </>
  );
}

function RunField({ machine, label }: { machine: string; label: string }) {
  const { data } = useResource<Run[]>(`/machines/${machine}/runs?limit=${RUNS}`);
  const closed = data?.filter((one) => (one.state === "closed" || isDwells(one)) && one.samples !== 0) ?? [];
  return (
    <label>
      {label}
      <select name="run" required>
        {closed.map((one) => (
          <option key={one.id} value={one.id}>{`${one.id}  ${term(one.kind)}, ${when(one.started_at)}`}</option>
        ))}
      </select>
      {data && closed.length === 0 && <small role="note">{t("noClosedRunYet")}</small>}
    </label>
  );
}

function WeightFields({ machine }: { machine: Document }) {
  return (
    <>
      <label>
        {t("disc")}
        <select name="disc" required>
          {machine.discs.map((one) => (
            <option key={one.id}>{one.id}</option>
          ))}
        </select>
      </label>
      <label>
        {t("amount")}
        <input name="amount" type="number" step="any" min="0" required />
      </label>
      <label>
        {t("unit")}
        <select name="unit">
          {UNITS.map((one) => (
            <option key={one}>{one}</option>
          ))}
        </select>
      </label>
      <label>
        {t("radiusOfAMassG")}
        <input name="radius" type="number" step="any" min="0" />
      </label>
      <label>
        {t("angleOnTheDiscS")}
        <input name="angle" type="number" step="any" min="-360" max="360" required />
      </label>
    </>
  );
}

/** Whether what was on in the trial before stayed on. */
function KeptField({ trial }: { trial: { run: number } }) {
  return (
    <label>
      <input name="kept" type="checkbox" /> {t("trialWeightsStillOn", { run: trial.run })}
    </label>
  );
}

/** What is on during a check run: as proposed, trimmed since, or what could be put on. */
function InstalledFields({ discs, trimmed }: { discs: string[]; trimmed: boolean }) {
  return (
    <>
      <label>
        {t("weightsThatAreOn")}
        <select name="installed">
          <option value="proposed">{t("thoseProposed")}</option>
          {trimmed && <option value="trimmed">{t("thoseTrimmed")}</option>}
          <option value="others">{t("othersStatedBelow")}</option>
        </select>
      </label>
      <details>
        <summary>{t("othersDiscByDisc")}</summary>
        {discs.map((disc) => (
          <div key={disc}>
            <label>
              {t("onDisc", { disc })}
              <input name={`on ${disc}`} type="number" step="any" min="0" />
            </label>
            <label>
              {t("atOnTheDiscsScale")}
              <input name={`at ${disc}`} type="number" step="any" min="-360" max="360" />
            </label>
          </div>
        ))}
      </details>
    </>
  );
}

function CorrectionFields({ machine }: { machine: Document }) {
  return (
    <>
      <label>
        {t("least")}
        <select name="criterion">
          <option value="least-squares">{t("squaresOfTheVibration")}</option>
          <option value="min-max">{t("largestVibration")}</option>
        </select>
      </label>
      <label>
        {t("balanceQualityGradeGIso")}
        <input name="grade" type="number" step="any" min="0.1" defaultValue="2.5" required />
      </label>
      <label>
        {t("speedsToBalanceAt")}
        <input name="speeds" inputMode="decimal" pattern="\s*(\d+([.,]\d+)?[\s;]*)*" placeholder={t("forExampleSpeeds")} />
      </label>
      {machine.discs.map((one) => (
        <DiscBounds key={one.id} disc={one.id} />
      ))}
    </>
  );
}

/** What may be put on a disc: at most so much, and into which holes; left empty, it is free. */
function DiscBounds({ disc }: { disc: string }) {
  const fields: [name: string, label: string, step: string][] = [
    ["limit", t("atMostGMm"), "any"],
    ["count", t("holes"), "1"],
    ["radius", t("theirRadiusMm"), "any"],
    ["first", t("firstHoleAt"), "any"],
    ["largest", t("mostInAHoleG"), "any"],
    ["step", t("stepsOfMassesG"), "any"],
  ];
  return (
    <details>
      <summary>{t("limitAndHoles", { disc })}</summary>
      {fields.map(([name, label, step]) => (
        <label key={name}>
          {label}
          <input name={`${name} ${disc}`} type="number" step={step} min={name === "first" ? "-360" : "0"} />
        </label>
      ))}
    </details>
  );
}

/** Take a trial run back; what was computed from it goes with it. */
export function WithdrawTrialDialog({ balancing, run, onStored, onClose }: { balancing: FieldBalancing; run: number; onStored: (balancing: FieldBalancing) => void; onClose: () => void }) {
  const list = `/machines/${balancing.machine}/balancings`;
  const givenUp = balancing.correction !== null;
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const body = { run, with_correction: givenUp, comment: String(form.get("comment")).trim(), by: author(form) };
    try {
      onStored(await post<FieldBalancing>(`${list}/${balancing.id}/withdrawals`, body, null, keys));
      await refetch(list);
    } catch (error) {
      void refetch(list);
      throw error;
    }
  };
  return (
    <FormDialog title={t("withdrawTrialRun", { run })} button={t("withdraw")} onSubmit={submit} onClose={onClose}>
      <p class="muted">{t("withdrawnStaysOnRecord")}</p>
      {givenUp && <p class="notice">{t("correctionIsGivenUpToo")}</p>}
      <CommentField label={t("why")} required />
    </FormDialog>
  );
}
