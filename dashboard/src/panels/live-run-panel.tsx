// The run that is being collected, drawn while it grows.
import type { Document, MachineState, Phasors } from "../schemas/answers";
import { slowRollWords } from "../data/run-identification";
import { Aging, Panel } from "../components/parts";
import { Plot } from "../plots/plot";
import { useResource } from "../data/resource";
import { bySpeed } from "../data/speed-sweep";

const MS = 1500;

export function LiveRun({ machine }: { machine: Document }) {
  const run = useResource<MachineState>(`/machines/${machine.id}/state`).data?.run;
  const answer = useResource<Phasors>(run ? `/runs/${run.id}/phasors?slow_roll=in_force` : null, MS);
  if (!run) return null;
  const phasors = answer.data;
  const sweep = phasors && bySpeed(phasors);
  return (
    <Panel title={`Run ${run.id}, as it comes`} class="live" aside={phasors && <p class="muted">{slowRollOf(phasors)}</p>}>
      <Aging answer={answer} />
      {sweep ? (
        <Plot
          label={`Amplitude over speed of run ${run.id} so far`}
          x={sweep.rpm}
          xUnit="rpm"
          yUnit="µm pp"
          curves={sweep.channels.map((channel, index) => ({ name: channel, y: sweep.amplitude[index]!, points: true }))}
          xRange={[machine.speed_range.minimum_rpm, machine.speed_range.maximum_rpm]}
          height={190}
        />
      ) : (
        <div class="waiting" style={{ minHeight: "190px" }} />
      )}
    </Panel>
  );
}

function slowRollOf({ slow_roll_version: version, slow_roll_left_out: leftOut }: Phasors): string {
  return slowRollWords(version, Object.keys(leftOut));
}
