// The parameters of a machine: one identification, compared with another, and the correlation of its estimates.
import { useEffect } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Loaded } from "../components/loading";
import { NoIdentification } from "../components/newest-identification";
import { Empty, Panel, Truncated } from "../components/panel";
import { isComparable } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { when } from "../format/times";
import { ComparisonPanel } from "../identification/comparison-panel";
import { CorrelationPanel } from "../identification/correlation-panel";
import { IdentificationPanels } from "../identification/identification-panels";
import { t, term } from "../messages/messages";
import type { Identification, IdentificationSummary } from "../schemas/identifications";
import type { Document } from "../schemas/machines";

const LIMIT = 200;

export function ParametersTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const list = useResource<IdentificationSummary[]>(`/machines/${machine.id}/identifications?limit=${LIMIT}`, 15_000);
  const chosen = query.get("identification") ?? String(list.data?.find(isComparable)?.id ?? list.data?.[0]?.id ?? "");
  const result = useResource<Identification>(chosen ? `/identifications/${chosen}` : null);
  useEffect(() => {
    if (chosen && !query.get("identification")) replaceQuery({ identification: chosen });
  }, [chosen, query]);
  if (list.data?.length === 0) return <NoIdentification />;
  return (
    <>
      <Panel title={t("selection")}>
        <div class="choices">
          <IdentificationSelect all={list.data ?? []} chosen={chosen} isListed={list.data !== undefined} />
          <Truncated shown={list.data?.length ?? 0} limit={LIMIT} />
        </div>
      </Panel>
      <Loaded result={result} lines={30}>
        {(found) =>
          found.machine === machine.id ? (
            <IdentificationPanels machine={machine} found={found} />
          ) : (
            <Empty>{t("identificationIsOfAnotherMachine", { id: found.id, machine: found.machine })}</Empty>
          )
        }
      </Loaded>
      {chosen && <ComparisonPanel shown={chosen} all={list.data ?? []} estimates={result.data?.estimates ?? []} />}
      {chosen && <CorrelationPanel identification={chosen} />}
    </>
  );
}

function IdentificationSelect({ all, chosen, isListed }: { all: IdentificationSummary[]; chosen: string; isListed: boolean }) {
  return (
    <label>
      {t("identification")}
      <select value={chosen} onChange={(event) => replaceQuery({ identification: event.currentTarget.value })}>
        {isListed && !all.some((one) => String(one.id) === chosen) && <option value={chosen}>{chosen}</option>}
        {all.map((one) => (
          <option key={one.id} value={one.id}>
            {one.id} {term(one.run_kind)}, {when(one.measured_at)}
            {one.scope === "run" ? "" : `, ${scopeLabel(one.scope)}`}
            {one.accepted ? "" : t("notAccepted")}
          </option>
        ))}
      </select>
    </label>
  );
}

function scopeLabel(scope: string): string {
  return scope === "gathered" ? t("pooled") : term(scope);
}
