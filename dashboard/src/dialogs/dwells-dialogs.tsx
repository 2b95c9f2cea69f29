// Make a run of the dwells at constant speed in a time range, and have one identified.
import { useState } from "preact/hooks";
import { MinuteField } from "../components/time-field";
import { post, type IdempotencyKeys } from "../data/http-client";
import { refetch, useResource } from "../data/resource";
import { minuteOf, when } from "../format/times";
import { t } from "../messages/messages";
import type { MachineState } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import { author, FormDialog } from "./form-dialog";

const MINUTE_MS = 60_000;
const HOUR_MS = 60 * MINUTE_MS;

/** onMade: called with the run that was made. */
export function DwellsDialog({ machine, onMade, onClose }: { machine: string; onMade: (run: Run) => void; onClose: () => void }) {
  const state = useResource<MachineState>(`/machines/${machine}/state`);
  const submit = async (form: FormData, keys: IdempotencyKeys) => {
    const [from, to] = ["first", "last"].map((name) => minuteOf(String(form.get(name)))!.toISOString());
    const made = await post<Run>(`/machines/${machine}/runs`, { from, to, by: author(form) }, null, keys);
    await refetch(`/machines/${machine}/runs`);
    onMade(made);
  };
  if (!state.data && !state.failure) return null; // in a moment: the times depend on it
  return (
    <FormDialog title={t("makeARunOfDwells")} button={t("make")} onSubmit={submit} onClose={onClose}>
      <p class="muted">{t("dwellsAreTaken")}</p>
      <TimeFields newest={state.data?.newest_sample_at ?? null} />
    </FormDialog>
  );
}

/** At first the last hour of which there are samples, up to a whole minute; it stays while others come. */
function TimeFields({ newest }: { newest: string | null }) {
  const [last] = useState(() => Math.ceil((newest ? Date.parse(newest) : Date.now()) / MINUTE_MS) * MINUTE_MS);
  return (
    <>
      <MinuteField label={t("firstTime")} name="first" required defaultValue={when(new Date(last - HOUR_MS).toISOString())} />
      <MinuteField label={t("lastTime")} name="last" required defaultValue={when(new Date(last).toISOString())} />
    </>
  );
}

export function IdentifyDwellsDialog({ run, onClose }: { run: Run; onClose: () => void }) {
  const submit = async (_: FormData, keys: IdempotencyKeys) => {
    await post(`/runs/${run.id}/identifications`, {}, null, keys);
    void refetch(`/machines/${run.machine}/jobs`);
  };
  return (
    <FormDialog title={t("identifyRun", { run: run.id })} button={t("identify")} named={false} onSubmit={submit} onClose={onClose}>
      <p class="muted">{t("dwellsAreIdentifiedBeside")}</p>
    </FormDialog>
  );
}
