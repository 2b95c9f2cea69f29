// One machine: its present state, and the tabs that show more of it.
import type { ComponentChildren } from "preact";
import { useState } from "preact/hooks";
import { link } from "../browser/router";
import { ErrorBoundary } from "../components/error-boundary";
import { Loaded } from "../components/loading";
import { MissingMachine } from "../components/missing";
import { Empty } from "../components/panel";
import { openAlertsPath } from "../data/open-alerts";
import { prefetch, useResource } from "../data/resource";
import { t } from "../messages/messages";
import { MachineStatus } from "../panels/machine-status";
import type { MachineRevision } from "../schemas/machines";
import { BalancingTab } from "./balancing-tab";
import { ModelTab } from "./model-tab";
import { OverviewTab } from "./overview-tab";
import { ParametersTab } from "./parameters-tab";
import { ResponseTab } from "./response-tab";
import { SettingsTab } from "./settings-tab";
import { ShapesTab } from "./shapes-tab";
import { TABS } from "./tabs";
import { TrendsTab } from "./trends-tab";
import { VibrationTab } from "./vibration-tab";

export function MachinePage({ id, tab }: { id: string; tab: string }) {
  useState(() => {
    // The first data to be seen are requested together with the document, not after it.
    if (tab === "overview") prefetch(`/machines/${id}/drawing`, openAlertsPath(id));
  });
  const result = useResource<MachineRevision>(`/machines/${id}`);
  if (result.failure?.status === 404) return <MissingMachine id={id} />;
  return (
    <Loaded result={result} lines={20}>
      {(found) => (
        <>
          <MachineStatus machine={found.document} revision={found.revision} />
          <nav class="tabs" aria-label={t("viewsOfTheMachine")}>
            {TABS.map((one) => (
              <a key={one.id} href={link(["machines", id, one.id])} aria-current={one.id === tab ? "page" : undefined}>
                {one.name}
              </a>
            ))}
            <a class="end" href={link(["reports", id])}>
              {t("report")}
            </a>
          </nav>
          <ErrorBoundary key={tab}>{tabContent(tab, found)}</ErrorBoundary>
        </>
      )}
    </Loaded>
  );
}

function tabContent(tab: string, found: MachineRevision): ComponentChildren {
  const machine = found.document;
  switch (tab) {
    case "overview":
      return <OverviewTab found={found} />;
    case "vibration":
      return <VibrationTab machine={machine} />;
    case "trends":
      return <TrendsTab machine={machine} />;
    case "response":
      return <ResponseTab machine={machine} />;
    case "shapes":
      return <ShapesTab machine={machine} />;
    case "model":
      return <ModelTab machine={machine} />;
    case "balancing":
      return <BalancingTab machine={machine} />;
    case "identified":
      return <ParametersTab machine={machine} />;
    case "settings":
      return <SettingsTab machine={machine} />;
    default:
      return <Empty>{t("thereIsNoSuchView")}</Empty>;
  }
}
