// The channels that are shown: those that the address names, else those beside what an alert is about, else the first ones.
import { useRef } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { useOpenAlerts } from "../data/open-alerts";
import { useResource } from "../data/resource";
import { elementName } from "../format/names";
import { t } from "../messages/messages";
import type { Document, Drawing } from "../schemas/machines";
import { nearestChannels } from "../train/nearest-probes";

/** Channels shown where none was chosen and no alert is open. */
const FIRST_CHANNELS = 2;

export interface ChosenChannels {
  chosen: string[];
  /** The element of the alert that they are beside; null where they were chosen otherwise. */
  beside: string | null;
  /** Whether it is not known yet which these are. */
  isPending: boolean;
}

export function useChosenChannels(machine: Document): ChosenChannels {
  const { query } = useStore(route);
  const channels = machine.probes.map((one) => one.id);
  const named = (query.get("channels") ?? "").split(",").filter((one) => channels.includes(one));
  const alerts = useOpenAlerts(machine.id);
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  const first = useRef<{ of: string; found: ChosenChannels } | null>(null);
  const of = [machine.id, ...channels].join();
  const isPending = [alerts, drawing].some((one) => !one.data && !one.failure);
  // An alert that is raised later does not change what is being looked at.
  if (!isPending && first.current?.of !== of) first.current = { of, found: openedWith(channels, drawing.data, alerts.data?.[0]?.element) };
  if (named.length > 0) return { chosen: named, beside: null, isPending: false };
  return first.current?.of === of ? first.current.found : { chosen: [], beside: null, isPending: true };
}

/** The channels beside an element with an open alert, else the first ones. */
function openedWith(channels: string[], drawing: Drawing | undefined, element: string | undefined): ChosenChannels {
  const near = drawing && element ? nearestChannels(drawing, element).filter((one) => channels.includes(one)) : [];
  if (element && near.length > 0) return { chosen: near, beside: element, isPending: false };
  return { chosen: channels.slice(0, FIRST_CHANNELS), beside: null, isPending: false };
}

export function ChannelButtons({ machine, chosen }: { machine: Document; chosen: string[] }) {
  const channels = machine.probes.map((one) => one.id);
  const toggle = (one: string) => {
    const next = channels.filter((other) => (other === one) !== chosen.includes(other));
    if (next.length > 0) replaceQuery({ channels: next.join(",") });
  };
  return (
    <span class="buttons" role="group" aria-label={t("channels")}>
      {channels.map((one) => (
        <button key={one} type="button" aria-pressed={chosen.includes(one)} onClick={() => toggle(one)}>
          {one}
        </button>
      ))}
    </span>
  );
}

export function BesideAlert({ beside, isPending }: Pick<ChosenChannels, "beside" | "isPending">) {
  if (isPending) return <p class="muted">…</p>;
  return beside ? <p class="muted">{t("theProbesBesideOfWhich", { element: elementName(beside) })}</p> : null;
}
