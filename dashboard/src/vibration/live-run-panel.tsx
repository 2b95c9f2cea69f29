// The run that is being collected, drawn while it grows.
import { inUnit, speedsInUnit, useUnits } from "../browser/units";
import { Loading, StaleNotice } from "../components/loading";
import { Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { speedSweep } from "../data/speed-sweep";
import { t } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { Document, MachineState } from "../schemas/machines";
import type { Phasors } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

const POLL_MS = 1500;

export function LiveRunPanel({ machine }: { machine: Document }) {
  const run = useResource<MachineState>(`/machines/${machine.id}/state`).data?.run;
  const result = useResource<Phasors>(run ? `/runs/${run.id}/phasors?slow_roll=in_force` : null, POLL_MS);
  const { amplitude, speed } = useUnits();
  if (!run) return null;
  const phasors = result.data;
  const sweep = phasors && speedSweep(phasors);
  return (
    <Panel title={t("runLive", { id: run.id })} class="live" aside={phasors && <p class="muted">{slowRollOf(phasors)}</p>}>
      <StaleNotice result={result} />
      {sweep ? (
        <Plot
          label={t("amplitudeSoFar", { id: run.id })}
          x={speedsInUnit(sweep.rpm, speed)}
          xUnit={speed.label}
          yUnit={amplitude.label}
          curves={sweep.channels.map((channel, index) => ({ name: channel, y: inUnit(sweep.amplitude[index]!, amplitude), points: true }))}
          xRange={[machine.speed_range.minimum_rpm * speed.factor, machine.speed_range.maximum_rpm * speed.factor]}
          height={190}
        />
      ) : (
        <Loading height="190px" />
      )}
    </Panel>
  );
}

function slowRollOf({ slow_roll_version: version, slow_roll_left_out: leftOut }: Phasors): string {
  return slowRollText(version, Object.keys(leftOut));
}
