// Begin and end a suppression of alerts.
import { MinuteField } from "../components/time-field";
import { getWithEtag, post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import { ALERT_RULES } from "../declarations/findings";
import { findingLabel } from "../findings/findings";
import { elementName, words } from "../format/names";
import { minuteOf } from "../format/times";
import { t } from "../messages/messages";
import type { Suppression } from "../schemas/alerts";
import type { Document } from "../schemas/machines";
import { suppressionScope } from "../words/alert-states";
import { elementsOfMachine } from "../words/elements";
import { author, CommentField, FormDialog } from "./form-dialog";

export function SuppressDialog({ machine, onClose }: { machine: Document; onClose: () => void }) {
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const until = String(form.get("until"));
    const body = {
      kind: form.get("kind"),
      rule: form.get("rule") || null,
      element: form.get("element") || null,
      until: minuteOf(until)?.toISOString() ?? null,
      by: author(form),
      comment: form.get("comment"),
    };
    await post(`/machines/${machine.id}/suppressions`, body, null, keys);
    refetchAlerts(machine.id);
  };
  return (
    <FormDialog title={t("suppressAlerts")} button={t("suppress")} onSubmit={submit} onClose={onClose}>
      <label>
        {t("kind")}
        <select name="kind">
          <option value="out_of_service">{t("outOfServiceAProbe")}</option>
          <option value="suppressed_by_design">{t("suppressedByDesignKnownAnd")}</option>
        </select>
      </label>
      <label>
        {t("finding")}
        <select name="rule">
          <option value="">{t("all")}</option>
          {ALERT_RULES.map((one) => (
            <option key={one} value={one}>
              {findingLabel(one)}
            </option>
          ))}
        </select>
      </label>
      <label>
        {t("element")}
        <select name="element">
          <option value="">{t("all")}</option>
          {elementsOfMachine(machine).map((one) => (
            <option key={one} value={one}>
              {elementName(one)}
            </option>
          ))}
        </select>
      </label>
      <MinuteField label={t("untilEmptyUntilItIs")} name="until" />
      <CommentField />
    </FormDialog>
  );
}

export function EndSuppressionDialog({ suppression, onClose }: { suppression: Suppression; onClose: () => void }) {
  const path = `/suppressions/${suppression.id}`;
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const [, etag] = await getWithEtag<Suppression>(path);
    await post(`${path}/end`, { by: author(form), comment: form.get("comment") }, etag, keys);
    refetchAlerts(suppression.machine);
  };
  return (
    <FormDialog title={t("endSuppression", { kind: words(suppression.kind), scope: suppressionScope(suppression) })} button={t("end")} onSubmit={submit} onClose={onClose}>
      <p class="muted">{t("alertsWhoseCauseIsStill")}</p>
      <CommentField />
    </FormDialog>
  );
}

function refetchAlerts(machine: string): void {
  void refetch(`/machines/${machine}/`);
  void refetch("/alerts");
  void refetch("/fleet");
}
