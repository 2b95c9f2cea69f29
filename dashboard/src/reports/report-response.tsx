// The response of the run that a report's identification is of, beside the first run of its baseline: Bode, polar, orbits.
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { useSpeedText } from "../components/speed";
import { isComparable } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { RunResponse } from "../identification/run-response";
import { t } from "../messages/messages";
import type { Alert } from "../schemas/alerts";
import type { Identification } from "../schemas/identifications";
import type { Document, Drawing } from "../schemas/machines";
import type { Run } from "../schemas/runs";
import type { Deviations } from "../schemas/trends";
import { nearestChannels } from "../train/nearest-probes";
import { OrbitPlots, runningSpeed, useOrbits } from "../vibration/orbits-panel";

/** Channels that are drawn where no alert says which; the report as PDF has all. */
const MOST_CHANNELS = 4;

interface Props {
  machine: Document;
  newest: Identification;
  /** Alerts open at the end of the period. */
  open: Alert[];
}

export function ResponseOfReport({ machine, newest, open }: Props) {
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`).data;
  const run = useResource<Run>(newest.runs[0] === undefined ? null : `/runs/${newest.runs[0]}`).data;
  const reference = useReference(machine.id, newest);
  const channels = machine.probes.map((one) => one.id);
  const near = drawing && open[0] ? nearestChannels(drawing, open[0].element).filter((one) => channels.includes(one)) : [];
  return (
    <>
      <RunResponse machine={machine} run={run} reference={reference} channels={near.length > 0 ? near : channels.slice(0, MOST_CHANNELS)} />
      {run && <OrbitsOfRun machine={machine} run={run} reference={reference} />}
    </>
  );
}

/** The first run of the baseline that the identification is compared with. */
function useReference(machine: string, newest: Identification): Run | undefined {
  const deviations = useResource<Deviations>(isComparable(newest) ? `/machines/${machine}/deviations?identification=${newest.id}` : null);
  const first = deviations.data?.baseline?.identifications[0];
  const compared = useResource<Identification>(first === undefined ? null : `/identifications/${first}`);
  const number = compared.data?.runs[0];
  return useResource<Run>(number === undefined ? null : `/runs/${number}`).data;
}

function OrbitsOfRun({ machine, run, reference }: { machine: Document; run: Run; reference: Run | undefined }) {
  const speed = runningSpeed(machine, run);
  const { result } = useOrbits(machine.id, run, reference, speed);
  const speedText = useSpeedText();
  return (
    <Panel class="whole" title={t("orbitsAtRunningSpeed", { speed: speedText(speed) })}>
      <Loaded result={result} lines={20}>
        {({ found, other }) => <OrbitPlots found={found} other={other} second={false} />}
      </Loaded>
    </Panel>
  );
}
