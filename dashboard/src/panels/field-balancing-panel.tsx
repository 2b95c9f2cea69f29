// Field balancing beside the machine: the newest one's steps, correction, promise, check run and vectors, on one printed page.
import { useState } from "preact/hooks";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { BalancingDialog, type BalancingStep } from "../dialogs/balancing-dialogs";
import { angleConvention, angleText } from "../format/angles";
import { number } from "../format/numbers";
import type { CheckRun, FieldBalancing, ProposedCorrection, Residual, Weight } from "../schemas/balancings";
import type { Document } from "../schemas/machines";
import { BalancingVectors } from "./balancing-vectors";

const STEPS: Record<FieldBalancing["state"], [step: BalancingStep, name: string][]> = {
  begun: [["trial", "Add a trial run …"]],
  tried: [["trial", "Add a trial run …"], ["correction", "Compute the correction …"]],
  proposed: [["correction", "Compute anew …"], ["check", "Compare a check run …"]],
  checked: [["check", "Compare another check run …"], ["correction", "Compute anew …"]],
};

export function FieldBalancingPanel({ machine }: { machine: Document }) {
  const [step, setStep] = useState<BalancingStep | null>(null);
  const [chosen, setChosen] = useState<number | null>(null);
  const result = useResource<FieldBalancing[]>(`/machines/${machine.id}/balancings`, 30_000);
  const shown = result.data?.find((one) => one.id === chosen) ?? result.data?.[0];
  return (
    <Panel
      title="Field balancing"
      aside={
        <span class="screen">
          <button type="button" onClick={() => setStep("begin")}>
            Begin …
          </button>{" "}
          {shown && (
            <button type="button" onClick={() => window.print()}>
              Print
            </button>
          )}
        </span>
      }
    >
      <Loaded result={result} lines={6}>
        {(list) =>
          shown ? (
            <>
              {list.length > 1 && (
                <label class="screen">
                  Balancing{" "}
                  <select value={shown.id} onChange={(event) => setChosen(Number(event.currentTarget.value))}>
                    {list.map((one) => (
                      <option key={one.id} value={one.id}>{`${one.id}, ${one.state}`}</option>
                    ))}
                  </select>
                </label>
              )}
              <Steps found={shown} onStep={setStep} />
              {shown.correction && <Correction found={shown.correction} check={shown.check} angles={scaleWords(shown, machine)} />}
              {shown.check && <Check found={shown.check} />}
              {shown.correction && <BalancingVectors correction={shown.correction} check={shown.check} />}
            </>
          ) : (
            <Empty>None yet. Begin with a run of the machine as it is; then one run with a trial weight on each disc.</Empty>
          )
        }
      </Loaded>
      {step && <BalancingDialog machine={machine} step={step} balancing={step === "begin" ? null : (shown ?? null)} onClose={() => setStep(null)} />}
    </Panel>
  );
}

function Steps({ found, onStep }: { found: FieldBalancing; onStep: (step: BalancingStep) => void }) {
  return (
    <>
      <p class="muted">
        Balancing {found.id}, begun <Time at={found.created_at} /> by {found.by}{found.comment && `: ${found.comment}`}
      </p>
      <ul>
        <li>Initial run {found.initial.join(", ")}</li>
        {found.trials.map((one) => (
          <li key={one.run}>
            Trial run {one.run}: {weightsText(one.weights)}
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
  const sense = { "x-to-y": "from +x towards +y", "with-rotation": "with the rotation", "against-rotation": "against the rotation" }[counted];
  return `on the disc's scale, ${sense}`;
}

function Correction({ found, check, angles }: { found: ProposedCorrection; check: CheckRun | null; angles: string }) {
  return (
    <>
      <p>{found.influence}</p>
      {found.notes.map((one) => (
        <p key={one} class="notice">
          {one}
        </p>
      ))}
      <div class="columns">
        <Scroll label="Table">
          <table>
            <thead>
              <tr>
                <th>Disc</th>
                <th class="number">Add</th>
                <th>Angle, {angles}</th>
                <th>Masses</th>
              </tr>
            </thead>
            <tbody>
              {found.planes.map((one) => (
                <tr key={one.disc}>
                  <td>{one.disc}</td>
                  <td class="number" title={`${number(one.lower_g_mm)} to ${number(one.upper_g_mm)} g·mm, 95 %`}>
                    {number(one.g_mm)} g·mm
                  </td>
                  <td>{angleText(one.scale_deg, one.half_width_deg)}</td>
                  <td>{one.masses.map((mass) => `${number(mass.grams)} g at ${Math.round(mass.scale_deg)}°`).join(", ")}</td>
                </tr>
              ))}
            </tbody>
          </table>
          <p class="muted">Counted from the state without trial weights: take these off first.</p>
        </Scroll>
        <Channels found={found} check={check} />
      </div>
      <Residuals found={found} check={check} />
    </>
  );
}

function Channels({ found, check }: { found: ProposedCorrection; check: CheckRun | null }) {
  const measured = (channel: string) => check?.channels.find((one) => one.channel === channel);
  return (
    <Scroll label="Table">
      <table>
        <thead>
          <tr>
            <th>Channel</th>
            <th class="number">Largest before</th>
            <th class="number">Promised, 95 %</th>
            {check && <th class="number">Check run</th>}
          </tr>
        </thead>
        <tbody>
          {found.channels.map((one) => (
            <tr key={one.channel}>
              <td>{one.channel}</td>
              <td class="number">{number(one.before_um_pp)} µm pp</td>
              <td class="number">below {number(one.upper_um_pp)} µm pp</td>
              {check && (
                <td class="number">
                  {number(measured(one.channel)?.check_um_pp)} µm pp{measured(one.channel)?.kept === false && ", more than promised"}
                </td>
              )}
            </tr>
          ))}
        </tbody>
      </table>
      {found.limit_um_pp !== null && (
        <p>
          Limit of the document {number(found.limit_um_pp)} µm pp: {found.limit_verdict}
          {check && check.limit_met !== null && `; by the check run ${check.limit_met ? "met" : "not met"}`}
        </p>
      )}
    </Scroll>
  );
}

function Residuals({ found, check }: { found: ProposedCorrection; check: CheckRun | null }) {
  return (
    <Scroll label="Table">
      <h3>
        Residual unbalance as of rigid rotors, ISO 21940-11 G {number(found.grade)} at {Math.round(found.service_rpm)} rpm
      </h3>
      <table>
        <thead>
          <tr>
            <th>Plane</th>
            <th class="number">Permissible</th>
            <th class="number">Before</th>
            <th class="number">Predicted after</th>
            {check && <th class="number">Check run</th>}
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
  return `${number(one.g_mm)} g·mm, below ${number(one.upper_g_mm)}: ${one.verdict}`;
}

function weightsText(weights: Weight[]): string {
  return weights.map((one) => `${number(one.g_mm)} g·mm on ${one.disc} at ${Math.round(one.scale_deg)}°`).join(", ") || "none on";
}

function Check({ found }: { found: CheckRun }) {
  return (
    <p>
      Check run {found.run}, <Time at={found.at} /> by {found.by}, {found.weights === null ? "with the weights proposed" : `with ${weightsText(found.weights)}`}: {found.points_kept} of {found.points} points within the prediction. To trim, add{" "}
      {weightsText(found.trim)}.
    </p>
  );
}
