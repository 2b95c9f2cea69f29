// Predictions of the newest identified model: Campbell diagram, critical speeds, oil films, shaft centreline, alignment, coupling loads, balancing.
import { NewestNotice, NoIdentification, PendingPanel } from "../components/newest-identification";
import { Time } from "../components/time";
import { useNewestIdentification } from "../data/newest-identification";
import { AlignmentPanel } from "../identification/alignment-panel";
import { BalancingPanel } from "../identification/balancing-panel";
import { CampbellPanel } from "../identification/campbell-panel";
import { CentrelinePanel } from "../identification/centreline-panel";
import { CouplingLoadsPanel } from "../identification/coupling-loads-panel";
import { CriticalSpeedsPanel } from "../identification/critical-speeds-panel";
import { OilFilmsPanel } from "../identification/oil-films-panel";
import { rich, t, term } from "../messages/messages";
import { BalancingGate } from "../panels/balancing-gate";
import type { Document } from "../schemas/machines";

function pathsOf(id: number) {
  const model = `/identifications/${id}/model`;
  return { campbell: `${model}/campbell`, criticals: `${model}/critical-speeds`, forces: `${model}/misalignment-force`, balancing: `${model}/balancing` };
}

export function ModelTab({ machine }: { machine: Document }) {
  const { newest, none, failure, list } = useNewestIdentification(machine.id, (id) => Object.values(pathsOf(id)));
  if (none) return <NoIdentification />;
  if (!newest) return <PendingPanel title={t("model")} failure={failure} />;
  const paths = pathsOf(newest.id);
  return (
    <>
      <NewestNotice failure={failure} list={list} />
      <p class="muted">
        {rich("modelOfIdentification", { id: newest.id, time: <Time at={newest.measured_at} />, kind: term(newest.run_kind) })}
      </p>
      <div class="columns">
        <CampbellPanel machine={machine} path={paths.campbell} />
        <CriticalSpeedsPanel machine={machine} path={paths.criticals} />
      </div>
      <OilFilmsPanel machine={machine} found={newest} />
      <CentrelinePanel machine={machine} found={newest} />
      <AlignmentPanel found={newest} />
      <CouplingLoadsPanel path={paths.forces} />
      <BalancingGate machine={machine.id}>{(hidden) => !hidden && <BalancingPanel path={paths.balancing} />}</BalancingGate>
    </>
  );
}
