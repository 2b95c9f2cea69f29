// Add a note or a maintenance to a machine's timeline.
import { useState } from "preact/hooks";
import { MinuteField } from "../components/time-field";
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch } from "../data/resource";
import { minuteOf, when } from "../format/times";
import { t } from "../messages/messages";
import { author, FormDialog } from "./form-dialog";

export function TimelineDialog({ machine, onClose }: { machine: string; onClose: () => void }) {
  const [opened] = useState(() => when(new Date().toISOString()));
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const at = minuteOf(String(form.get("at")))!.toISOString();
    const body = { at, kind: form.get("kind"), text: form.get("text"), by: author(form) };
    try {
      await post(`/machines/${machine}/timeline`, body, null, keys);
    } finally {
      void refetch(`/machines/${machine}/`);
    }
  };
  return (
    <FormDialog title={t("addANoteOrA")} button={t("add")} onSubmit={submit} onClose={onClose}>
      <label>
        {t("kind")}
        <select name="kind">
          <option value="note">{t("note")}</option>
          <option value="maintenance">{t("maintenanceANewBaselineBegins")}</option>
          <option value="marker">{t("marker")}</option>
        </select>
      </label>
      <MinuteField label={t("time")} name="at" required defaultValue={opened} />
      <label>
        {t("text")}
        <textarea name="text" rows={3} required maxLength={2000} />
      </label>
    </FormDialog>
  );
}
