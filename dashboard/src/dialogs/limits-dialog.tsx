// Change the limits of one kind of finding.
import { getWithEtag, put } from "../data/http-client";
import { refetch } from "../data/resource";
import { findingLabel, LEVELS, limitQuantities, type FindingKind } from "../findings/findings";
import { t, term } from "../messages/messages";
import type { Level, Limits, LimitsVersion, Rule } from "../schemas/alerts";
import { author, CommentField, FormDialog } from "./form-dialog";

interface Props {
  machine: string;
  kind: FindingKind;
  shown: LimitsVersion;
  onClose: () => void;
}

export function LimitsDialog({ machine, kind, shown, onClose }: Props) {
  const rule = shown.limits[kind];
  const submit = async (form: FormData) => {
    const path = `/machines/${machine}/limits`;
    const [now, etag] = await getWithEtag<LimitsVersion>(path);
    // Limits that somebody else has set meanwhile are not overwritten: the ETag is of those shown.
    const tag = now.version === shown.version ? etag : `"${shown.version}"`;
    const limits: Limits = { ...shown.limits, [kind]: ruleOf(kind, rule, form) };
    await put(path, { by: author(form), comment: form.get("comment"), limits }, tag);
    void refetch(path);
  };
  return (
    <FormDialog title={t("limits", { finding: findingLabel(kind) })} button={t("apply")} onSubmit={submit} onClose={onClose}>
      <p class="muted">{t("limitsHoldFromNext")}</p>
      {LEVELS.map((level) => (
        <fieldset key={level}>
          <legend>{term(level)}</legend>
          {limitQuantities(kind).map((one) => (
            <label key={one.name}>
              {one.label} [{one.unit}]
              <input type="number" name={`${level}.${one.name}`} min={0} step="any" defaultValue={rule[level]?.[one.name]?.toString() ?? ""} />
            </label>
          ))}
        </fieldset>
      ))}
      <label>
        {t("onDelayLabel")}
        <input type="number" name="on_delay" min={1} step={1} required defaultValue={String(rule.on_delay)} />
      </label>
      <label>
        {t("offDelayLabel")}
        <input type="number" name="off_delay" min={1} step={1} required defaultValue={String(rule.off_delay)} />
      </label>
      <label class="switch">
        <input type="checkbox" name="latching" defaultChecked={rule.latching} /> {t("latchingMustBeResetBy")}
      </label>
      <CommentField required />
    </FormDialog>
  );
}

/** The rule as entered; what the form has no field for stays as before. */
function ruleOf(kind: FindingKind, before: Rule, form: FormData): Rule {
  const danger = levelOf(kind, "danger", form);
  return {
    ...before,
    alert: levelOf(kind, "alert", form),
    danger: Object.values(danger).every((one) => one === null) ? null : danger,
    on_delay: Number(form.get("on_delay")),
    off_delay: Number(form.get("off_delay")),
    latching: form.get("latching") === "on",
  };
}

function levelOf(kind: FindingKind, which: string, form: FormData): Level {
  const level: Level = {
    sigma: null,
    per_cent: null,
    force: null,
    rate_per_cent_per_week: null,
    tolerance_per_cent: null,
    beyond_tolerance: null,
  };
  for (const { name } of limitQuantities(kind)) {
    const text = String(form.get(`${which}.${name}`) ?? "").trim();
    level[name] = text === "" ? null : Number(text);
  }
  return level;
}
