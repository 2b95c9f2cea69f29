// Field balancing of a machine, for the person beside it; it gives way where a danger is open that no balancing mends.
import { useState } from "preact/hooks";
import { link } from "../browser/router";
import { Panel } from "../components/panel";
import { Severity } from "../components/severity";
import { useOpenAlerts } from "../data/open-alerts";
import { t } from "../messages/messages";
import { FieldBalancingPanel } from "../panels/field-balancing-panel";
import type { Alert } from "../schemas/alerts";
import type { Document } from "../schemas/machines";
import { alertTitle } from "../words/alert-states";

/** What balancing is for. */
const MENDED_BY_BALANCING = "unbalance";

export function BalancingTab({ machine }: { machine: Document }) {
  const dangers = (useOpenAlerts(machine.id).data ?? []).filter((one) => one.severity === "danger" && one.rule !== MENDED_BY_BALANCING);
  const [anyway, setAnyway] = useState(false);
  const waits = dangers.length > 0;
  // The panel keeps its place whatever comes: a danger that is raised meanwhile ends no form that somebody is filling in.
  return (
    <>
      {waits && <Dangers dangers={dangers} />}
      {waits && (
        <p class="buttons screen">
          <button type="button" aria-expanded={anyway} onClick={() => setAnyway(!anyway)}>
            {anyway ? "▾" : "▸"} {t("balanceAllTheSame")}
          </button>
        </p>
      )}
      <FieldBalancingPanel key="balancing" machine={machine} hidden={waits && !anyway} warning={waits ? t("notNowADangerIs") : null} />
    </>
  );
}

function Dangers({ dangers }: { dangers: Alert[] }) {
  return (
    <Panel title={t("notNowADangerIs")}>
      <p>{t("balancingWouldHideWhatIs")}</p>
      <ul class="reasons">
        {dangers.map((one) => (
          <li key={one.id}>
            <Severity severity={one.severity} /> <a href={link(["alerts", String(one.id)])}>{alertTitle(one)}</a>: {one.message}
          </li>
        ))}
      </ul>
    </Panel>
  );
}
