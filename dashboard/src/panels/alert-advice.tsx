// What an alert means for a person: how far, how sure, how urgent, what to check and to do, what would confirm it.
import type { ComponentChildren } from "preact";
import { t, term } from "../messages/messages";
import type { Advice } from "../schemas/alerts";

export function AlertAdvice({ advice }: { advice: Advice }) {
  const opportunities = [...new Set(advice.actions.map((one) => one.opportunity))];
  return (
    <dl class="facts advice">
      <Lines name={t("howFar")} lines={advice.how_far.map((one) => one.words)} />
      <Lines name={t("howSure")} lines={[advice.how_sure.words]} />
      <Lines name={t("howUrgent")} lines={[advice.how_urgent.words]} />
      {opportunities.map((when) => (
        <Lines key={when} name={t("doWhen", { when: term(when) })} lines={advice.actions.filter((one) => one.opportunity === when).map((one) => one.text)} />
      ))}
      <Lines name={t("check")} lines={advice.check} />
      <Lines name={t("wouldConfirmIt")} lines={advice.confirm} />
      <Lines name={t("notDeterminedHead")} lines={advice.not_determined} />
    </dl>
  );
}

function Lines({ name, lines }: { name: string; lines: string[] }): ComponentChildren {
  const told = lines.filter(Boolean);
  if (told.length === 0) return null;
  return (
    <>
      <dt>{name}</dt>
      <dd>{told.length === 1 ? told[0] : <ul class="reasons">{told.map((one) => <li key={one}>{one}</li>)}</ul>}</dd>
    </>
  );
}
