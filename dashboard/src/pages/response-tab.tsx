// The response of a chosen run, another one overlaid, at chosen channels: at first those beside what an alert is about.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Empty, Panel } from "../components/panel";
import { RunSelect } from "../components/run-select";
import { useOpenAlerts } from "../data/open-alerts";
import { useResource } from "../data/resource";
import { useRunSelection } from "../data/run-selection";
import { elementName } from "../format/names";
import type { Document, Drawing } from "../schemas/machines";
import { nearestChannels } from "../train/nearest-probes";
import { RunResponse } from "./run-response";

/** Channels shown where none was chosen and no alert is open. */
const FIRST_CHANNELS = 2;

export function ResponseTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const runs = useRunSelection(machine.id);
  const { run, reference } = runs;
  const { chosen, beside } = useChannels(machine);
  if (runs.all?.length === 0) {
    return (
      <Panel title="Bode and polar">
        <Empty>No run yet. A run begins when the speed sweeps through the machine's range.</Empty>
      </Panel>
    );
  }
  return (
    <>
      <Panel title="Selection">
        <div class="choices">
          <RunSelect {...runs} />
          <ChannelButtons channels={machine.probes.map((one) => one.id)} chosen={chosen} />
          <SlowRollSwitch checked={query.get("slow_roll") !== "none"} />
        </div>
        {beside && <p class="muted">The probes beside {elementName(beside)}, of which an alert is open.</p>}
      </Panel>
      {!run && runs.failure ? (
        <p class="error" role="alert">
          {runs.failure}
        </p>
      ) : (
        <RunResponse machine={machine} run={run} reference={reference} channels={chosen} asMeasured={query.get("slow_roll") === "none"} />
      )}
    </>
  );
}

/** The channels that the address names, else those beside the element of the first open alert, else the first ones. */
function useChannels(machine: Document): { chosen: string[]; beside: string | null } {
  const { query } = useStore(route);
  const channels = machine.probes.map((one) => one.id);
  const named = (query.get("channels") ?? "").split(",").filter((one) => channels.includes(one));
  const element = useOpenAlerts(machine.id).data?.[0]?.element;
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`).data;
  const near = drawing && element ? nearestChannels(drawing, element).filter((one) => channels.includes(one)) : [];
  if (named.length > 0) return { chosen: named, beside: null };
  return near.length > 0 ? { chosen: near, beside: element! } : { chosen: channels.slice(0, FIRST_CHANNELS), beside: null };
}

function SlowRollSwitch({ checked }: { checked: boolean }) {
  return (
    <label class="switch">
      <input type="checkbox" checked={checked} onChange={(event) => replaceQuery({ slow_roll: event.currentTarget.checked ? null : "none" })} />
      slow roll subtracted
    </label>
  );
}

function ChannelButtons({ channels, chosen }: { channels: string[]; chosen: string[] }) {
  const toggle = (one: string) => {
    const next = channels.filter((other) => (other === one) !== chosen.includes(other));
    if (next.length > 0) replaceQuery({ channels: next.join(",") });
  };
  return (
    <span class="buttons" role="group" aria-label="Channels">
      {channels.map((one) => (
        <button key={one} type="button" aria-pressed={chosen.includes(one)} onClick={() => toggle(one)}>
          {one}
        </button>
      ))}
    </span>
  );
}
