// Another machine of the fleet that the address names, whose data are shown beside those of the page's own.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { useResource } from "../data/resource";
import { t } from "../messages/messages";
import type { Document, Fleet } from "../schemas/machines";

/** Its id; undefined where none is named. */
export function useOtherMachine(machine: string): string | undefined {
  const id = useStore(route).query.get("beside");
  return id && id !== machine ? id : undefined;
}

interface Props {
  machine: Document;
  chosen: string | undefined;
  label: string;
}

/** Those of the same plant come first. */
export function OtherMachineSelect({ machine, chosen, label }: Props) {
  const fleet = useResource<Fleet>("/fleet").data?.machines ?? [];
  const others = fleet.filter((one) => one.id !== machine.id);
  const sorted = [...others.filter((one) => one.plant === machine.plant), ...others.filter((one) => one.plant !== machine.plant)];
  return (
    <label>
      {label}
      <select value={chosen ?? ""} onChange={(event) => replaceQuery({ beside: event.currentTarget.value || null })}>
        <option value="">{t("noOtherMachine")}</option>
        {sorted.map((one) => (
          <option key={one.id} value={one.id}>
            {one.plant === machine.plant ? one.name : `${one.plant} / ${one.name}`}
          </option>
        ))}
      </select>
    </label>
  );
}
