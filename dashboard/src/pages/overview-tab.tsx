// A machine at a glance: the train with what has changed, warnings of its document, open alerts, deviations, notes, the newest runs.
import { navigate } from "../browser/router";
import { Loaded } from "../components/loading";
import { notComparableText } from "../components/newest-identification";
import { Panel, Truncated } from "../components/panel";
import { useDeviations } from "../data/machine-deviations";
import { useNewestSummary } from "../data/newest-identification";
import { MAX_OPEN_ALERTS, useOpenAlerts } from "../data/open-alerts";
import { useResource } from "../data/resource";
import { t } from "../messages/messages";
import { AlertList } from "../panels/alert-list";
import { DeviationsPanel } from "../panels/deviations-panel";
import { DocumentWarningsPanel } from "../panels/document-warnings-panel";
import { NewestRunsPanel } from "../panels/newest-runs-panel";
import { TimelinePanel } from "../panels/timeline-panel";
import type { Drawing, MachineRevision } from "../schemas/machines";
import { elementMarks } from "../train/marks";
import { TrainDrawing } from "../train/train-drawing";
import { TrainLegend } from "../train/train-legend";
import { LiveRunPanel } from "../vibration/live-run-panel";
import { VibrationBarsPanel } from "../vibration/vibration-bars-panel";

export function OverviewTab({ found }: { found: MachineRevision }) {
  const machine = found.document;
  const alerts = useOpenAlerts(machine.id);
  const summary = useNewestSummary(machine.id);
  const { deviations, next } = useDeviations(machine.id, summary);
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`);
  return (
    <>
      <div class="beside">
        <div>
          <Panel title={t("train")} aside={<TrainLegend />}>
            <Loaded result={drawing} lines={15}>
              {(train) => (
                <TrainDrawing
                  name={machine.name}
                  drawing={train}
                  marks={elementMarks(alerts.data ?? [], deviations.data)}
                  onChoose={(element) => navigate(["machines", machine.id, "trends"], { element })}
                />
              )}
            </Loaded>
          </Panel>
          <Panel title={t("openAlerts")}>
            <AlertList result={alerts} none={t("noOpenAlerts")} />
            <Truncated shown={alerts.data?.length ?? 0} limit={MAX_OPEN_ALERTS} />
          </Panel>
        </div>
        <VibrationBarsPanel machine={machine} />
      </div>
      <DocumentWarningsPanel {...found} />
      <div class="columns">
        <div>
          <DeviationsPanel machine={machine} result={deviations} next={next} none={notComparableText(summary)} />
        </div>
        <div>
          <LiveRunPanel machine={machine} />
          <TimelinePanel machine={machine} />
        </div>
      </div>
      <NewestRunsPanel machine={machine.id} />
    </>
  );
}
