// What an alert means for a person: how far, how sure, how urgent, what to check and to do, what would confirm it.
import type { ComponentChildren } from "preact";
import { t, term } from "../messages/messages";
import type { Advice } from "../schemas/alerts";

export function AlertAdvice({ advice }: { advice: Advice }) {
  const opportunities = [...new Set(advice.actions.map((one) => one.opportunity))];
  return (
    <dl class="facts advice">
      <AdviceLines name={t("howFar")} lines={advice.how_far.map((one) => one.words)} />
      <AdviceLines name={t("howSure")} lines={[advice.how_sure.words]} />
      <AdviceLines name={t("howUrgent")} lines={[advice.how_urgent.words]} />
      {opportunities.map((when) => (
        <AdviceLines key={when} name={t("doWhen", { when: term(when) })} lines={advice.actions.filter((one) => one.opportunity === when).map((one) => one.text)} />
      ))}
      <AdviceLines name={t("check")} lines={advice.check} />
      <AdviceLines name={t("wouldConfirmIt")} lines={advice.confirm} />
      <AdviceLines name={t("notDeterminedHead")} lines={advice.not_determined} />
    </dl>
  );
}

function AdviceLines({ name, lines }: { name: string; lines: string[] }): ComponentChildren {
  const filled = lines.filter(Boolean);
  if (filled.length === 0) return null;
  return (
    <>
      <dt>{name}</dt>
      <dd>{filled.length === 1 ? filled[0] : <ul class="reasons">{filled.map((one) => <li key={one}>{one}</li>)}</ul>}</dd>
    </>
  );
}
