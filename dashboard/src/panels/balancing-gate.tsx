// What is for balancing gives way where an alert says that something else than unbalance is wrong; it can be opened all the same.
import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import { link } from "../browser/router";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Severity } from "../components/severity";
import { useOpenAlerts } from "../data/open-alerts";
import { speaksAgainstBalancing } from "../findings/findings";
import { t } from "../messages/messages";
import type { Alert } from "../schemas/alerts";
import { alertTitle } from "../words/alert-states";

interface Props {
  machine: string;
  /** hidden: whether it is kept out of sight. warning: what speaks against balancing now; null for nothing. */
  children: (hidden: boolean, warning: string | null) => ComponentChildren;
}

export function BalancingGate({ machine, children }: Props) {
  return <Loaded result={useOpenAlerts(machine)}>{(alerts) => <Gate alerts={alerts}>{children}</Gate>}</Loaded>;
}

function Gate({ alerts, children }: { alerts: Alert[]; children: Props["children"] }) {
  const others = alerts.filter(speaksAgainstBalancing);
  const [anyway, setAnyway] = useState(false);
  const waits = others.length > 0;
  return (
    <>
      {waits && <Others alerts={others} />}
      {waits && (
        <p class="buttons screen">
          <button type="button" aria-expanded={anyway} onClick={() => setAnyway(!anyway)}>
            {anyway ? "▾" : "▸"} {t("balanceAllTheSame")}
          </button>
        </p>
      )}
      {children(waits && !anyway, waits ? t("notNowSomethingElseIs") : null)}
    </>
  );
}

function Others({ alerts }: { alerts: Alert[] }) {
  return (
    <Panel title={t("notNowSomethingElseIs")}>
      <p>{t("balancingWouldHideWhatIs")}</p>
      <ul class="reasons">
        {alerts.map((one) => (
          <li key={one.id}>
            <Severity severity={one.severity} /> <a href={link(["alerts", String(one.id)])}>{alertTitle(one)}</a>: {one.message}
          </li>
        ))}
      </ul>
    </Panel>
  );
}
