// The response of a chosen run, another one overlaid, at chosen channels: at first those beside what an alert is about.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Loading } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { RunSelect } from "../components/run-select";
import { useResource } from "../data/resource";
import { useRunSelection } from "../data/run-selection";
import { t } from "../messages/messages";
import { IdentifyDwellsButton } from "../panels/dwells-buttons";
import type { Document } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import { BesideAlert, ChannelButtons, useChosenChannels } from "./chosen-channels";
import { OtherMachineSelect, useOtherMachine } from "./other-machine";
import { RunResponse } from "../identification/run-response";

export function ResponseTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const runs = useRunSelection(machine.id);
  const { run, reference } = runs;
  const order = query.get("order") === "2" ? 2 : 1;
  const other = useOtherMachine(machine.id);
  const otherRun = useNewestRun(other);
  const { chosen, beside, isPending } = useChosenChannels(machine);
  if (runs.all?.length === 0) {
    return (
      <Panel title={t("bodeAndPolar")}>
        <Empty>{t("noRunYetSweep")}</Empty>
      </Panel>
    );
  }
  return (
    <>
      <Panel title={t("selection")}>
        <div class="choices">
          <RunSelect {...runs} />
          <IdentifyDwellsButton run={run} />
          <OtherMachineSelect machine={machine} chosen={other} label={t("newestRunOf")} />
          <ChannelButtons machine={machine} chosen={chosen} />
          <OrderButtons order={order} />
          <SlowRollSwitch machine={machine.id} checked={query.get("slow_roll") !== "none"} />
        </div>
        <BesideAlert beside={beside} isPending={isPending} />
      </Panel>
      {!run && runs.failure ? (
        <p class="error" role="alert">
          {runs.failure}
        </p>
      ) : isPending ? (
        <Loading height="720px" />
      ) : (
        <RunResponse machine={machine} run={run} reference={otherRun ?? reference} overlaid={other} order={order} channels={chosen} asMeasured={query.get("slow_roll") === "none"} />
      )}
    </>
  );
}

function OrderButtons({ order }: { order: 1 | 2 }) {
  return (
    <span class="buttons" role="group" aria-label={t("order")}>
      {([1, 2] as const).map((one) => (
        <button key={one} type="button" aria-pressed={one === order} onClick={() => replaceQuery({ order: one === 1 ? null : String(one) })}>
          {one}×
        </button>
      ))}
    </span>
  );
}

/** The newest run with samples of another machine. */
function useNewestRun(machine: string | undefined): Run | undefined {
  const runs = useResource<Run[]>(machine ? `/machines/${encodeURIComponent(machine)}/runs?limit=50` : null).data;
  return runs?.find((one) => one.state === "closed" && one.samples !== 0);
}

/** Off and not to be switched on where there is nothing to subtract. */
function SlowRollSwitch({ machine, checked }: { machine: string; checked: boolean }) {
  const isNone = useResource<{ versions: unknown[] }>(`/machines/${machine}/slow-roll?limit=1`).data?.versions.length === 0;
  return (
    <label class="switch" title={isNone ? t("noSlowRollVectors") : undefined}>
      <input type="checkbox" checked={checked && !isNone} disabled={isNone} onChange={(event) => replaceQuery({ slow_roll: event.currentTarget.checked ? null : "none" })} />
      {t("slowRollSubtracted")}
    </label>
  );
}

