// From where on a finding is an alert or a danger; who set that, and why.
import { useState } from "preact/hooks";
import type { Document, Level, Limits, LimitsVersion, Rule } from "../schemas/answers";
import { getToChange, put } from "../data/http-client";
import { AskDialog, Comment } from "../dialogs/form-dialog";
import { elementName } from "../words/format";
import { Panel, Shown, Time } from "../components/parts";
import { refresh, useResource } from "../data/resource";
import { RULES, type RuleName } from "../words/findings";

const SIZES: { name: keyof Level; words: string; unit: string; only?: RuleName }[] = [
  { name: "sigma", words: "certainty", unit: "σ" },
  { name: "per_cent", words: "change", unit: "%" },
  { name: "force", words: "force in the coupling", unit: "N", only: "misalignment" },
  { name: "rate_per_cent_per_week", words: "rate", unit: "% a week", only: "rate_of_change" },
];
const LEVELS = ["alert", "danger"] as const;

export function LimitsPanel({ machine }: { machine: Document }) {
  const [changed, setChanged] = useState<RuleName | null>(null);
  const answer = useResource<LimitsVersion>(`/machines/${machine.id}/limits`);
  return (
    <Panel title="Limits">
      <Shown answer={answer} lines={12}>
        {(found) => (
          <>
            <p class="muted">
              {found.version === 0 ? (
                "The defaults; nobody has set others."
              ) : (
                <>
                  Version {found.version}, set <Time at={found.set_at} /> by {found.by}: {found.comment}
                </>
              )}
            </p>
            <Table limits={found.limits} onChange={setChanged} />
            <Elements limits={found.limits} />
            {changed && <Change machine={machine.id} name={changed} shown={found} onClose={() => setChanged(null)} />}
          </>
        )}
      </Shown>
    </Panel>
  );
}

function Table({ limits, onChange }: { limits: Limits; onChange: (name: RuleName) => void }) {
  return (
    <div class="scroll">
      <table class="limits">
        <thead>
          <tr>
            <th>Finding</th>
            <th>Alert from</th>
            <th>Danger from</th>
            <th class="number">Seen in a row</th>
            <th class="number">Gone in a row</th>
            <th class="number">Hysteresis</th>
            <th>Latching</th>
            <th />
          </tr>
        </thead>
        <tbody>
          {RULES.map((name) => (
            <tr key={name} data-rule={name}>
              <th scope="row">{name.replaceAll("_", " ")}</th>
              <td>{inWords(limits[name].alert)}</td>
              <td>{inWords(limits[name].danger)}</td>
              <td class="number">{limits[name].on_delay}</td>
              <td class="number">{limits[name].off_delay}</td>
              <td class="number">{Math.round(100 * limits[name].hysteresis)} %</td>
              <td>{limits[name].latching ? "yes" : "no"}</td>
              <td>
                <button type="button" onClick={() => onChange(name)} aria-label={`Change limits of ${name.replaceAll("_", " ")}`}>
                  Change …
                </button>
              </td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function inWords(level: Level | null): string {
  if (level === null) return "never";
  const said = SIZES.filter(({ name }) => level[name] !== null).map(({ name, unit }) => `${level[name]} ${unit}`);
  return said.join(", ");
}

/** Single elements with rules of their own. */
function Elements({ limits }: { limits: Limits }) {
  const own = Object.entries(limits.elements);
  if (own.length === 0) return null;
  return (
    <>
      <h3>Rules of single elements</h3>
      <ul>
        {own.flatMap(([element, rules]) =>
          Object.entries(rules).map(([name, rule]) => (
            <li key={`${element} ${name}`}>
              {elementName(element)}, {name.replaceAll("_", " ")}: alert from {inWords(rule.alert)}; danger from {inWords(rule.danger)}
            </li>
          )),
        )}
      </ul>
    </>
  );
}

function Change(props: { machine: string; name: RuleName; shown: LimitsVersion; onClose: () => void }) {
  const { machine, name, shown, onClose } = props;
  const rule = shown.limits[name];
  const submit = async (form: FormData) => {
    const path = `/machines/${machine}/limits`;
    const [now, etag] = await getToChange<LimitsVersion>(path);
    // Limits that somebody else has set meanwhile are not written over: the tag is of those that were shown.
    const tag = now.version === shown.version ? etag : `"${shown.version}"`;
    const limits: Limits = { ...shown.limits, [name]: asked(name, rule, form) };
    await put(path, { by: String(form.get("by")).trim(), comment: form.get("comment"), limits }, tag);
    refresh(path);
  };
  return (
    <AskDialog title={`Limits: ${name.replaceAll("_", " ")}`} button="Put in force" onSubmit={submit} onClose={onClose}>
      <p class="muted">The next identification is judged by them. An empty field does not matter; a danger without any never comes.</p>
      {LEVELS.map((level) => (
        <fieldset key={level}>
          <legend>{level}</legend>
          {sizesOf(name).map((size) => (
            <label key={size.name}>
              {size.words} [{size.unit}]
              <input type="number" name={`${level}.${size.name}`} min={0} step="any" defaultValue={rule[level]?.[size.name]?.toString() ?? ""} />
            </label>
          ))}
        </fieldset>
      ))}
      <label>
        Identifications in a row that must show it
        <input type="number" name="on_delay" min={1} step={1} required defaultValue={String(rule.on_delay)} />
      </label>
      <label>
        Identifications in a row that must no longer show it
        <input type="number" name="off_delay" min={1} step={1} required defaultValue={String(rule.off_delay)} />
      </label>
      <label class="switch">
        <input type="checkbox" name="latching" defaultChecked={rule.latching} /> latching: a person must reset it
      </label>
      <Comment required />
    </AskDialog>
  );
}

function sizesOf(rule: RuleName) {
  return SIZES.filter(({ only }) => only === undefined || only === rule);
}

function asked(name: RuleName, before: Rule, form: FormData): Rule {
  const level = (which: string): Level => {
    const found: Level = { sigma: null, per_cent: null, force: null, rate_per_cent_per_week: null };
    for (const size of sizesOf(name)) {
      const text = String(form.get(`${which}.${size.name}`) ?? "").trim();
      found[size.name] = text === "" ? null : Number(text);
    }
    return found;
  };
  const danger = level("danger");
  return {
    ...before,
    alert: level("alert"),
    danger: Object.values(danger).every((one) => one === null) ? null : danger,
    on_delay: Number(form.get("on_delay")),
    off_delay: Number(form.get("off_delay")),
    latching: form.get("latching") === "on",
  };
}
