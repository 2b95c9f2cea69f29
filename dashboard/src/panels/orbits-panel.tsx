// The 1× orbits at the probes, at a chosen speed of a run.
import { useState } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { ErrorMessage, Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { RunSelect } from "../components/run-select";
import type { ApiError } from "../data/http-client";
import { useLastComplete } from "../data/last-complete";
import { useResource, type QueryResult } from "../data/resource";
import { useRunIdentification } from "../data/run-identification";
import { useRunSelection } from "../data/run-selection";
import { number, rpm } from "../format/numbers";
import { niceStep } from "../plots/axis-steps";
import { OrbitPlot } from "../plots/orbit-plot";
import type { Document } from "../schemas/machines";
import type { Orbits, Run } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

interface OrbitsAndOverlay {
  found: Orbits;
  other: Orbits | undefined;
}

export function OrbitsPanel({ machine }: { machine: Document }) {
  const runs = useRunSelection(machine.id);
  const { query } = useStore(route);
  const { minimum_rpm: low, maximum_rpm: high } = machine.speed_range;
  const speed = Number(query.get("rpm")) || Math.round((low + high) / 2);
  const { result, failure } = useOrbits(machine.id, runs.run, runs.reference, speed);
  return (
    <Panel title="1× orbits at the probes">
      <div class="choices">
        <RunSelect {...runs} />
        <SpeedSlider low={low} high={high} speed={speed} />
      </div>
      {failure?.isLocal && <ErrorMessage failure={failure} />}
      {runs.all?.length === 0 ? (
        <Empty>No run yet.</Empty>
      ) : !runs.run && runs.failure ? (
        <p class="error" role="alert">
          {runs.failure}
        </p>
      ) : (
        <Loaded result={result} lines={20}>
          {({ found, other }) => <OrbitPlots found={found} other={other} />}
        </Loaded>
      )}
    </Panel>
  );
}

/** The orbits of a run and of the one overlaid, without the same slow roll, once both are loaded. */
function useOrbits(machine: string, run: Run | undefined, reference: Run | undefined, speed: number): { result: QueryResult<OrbitsAndOverlay>; failure: ApiError | undefined } {
  const { slowRoll, failure } = useRunIdentification(machine, run);
  const orbitsPath = (of: Run | undefined) => (of && slowRoll ? `/runs/${of.id}/orbits?rpm=${speed}&slow_roll=${slowRoll}` : null);
  const found = useResource<Orbits>(orbitsPath(run));
  const other = useResource<Orbits>(orbitsPath(reference));
  const isComplete = !reference || other.data || other.failure;
  const now = found.data && isComplete ? { found: found.data, other: other.data } : undefined;
  const complete = useLastComplete<OrbitsAndOverlay>([run?.id, reference?.id, speed].join(), now);
  return { result: { ...found, data: found.data || !found.failure?.isLocal ? complete : undefined }, failure };
}

/** The speed is shown while it is dragged, and chosen when it is let go. */
function SpeedSlider({ low, high, speed }: { low: number; high: number; speed: number }) {
  const [dragged, setDragged] = useState<number | null>(null);
  return (
    <label class="wide">
      Speed: {rpm(dragged ?? speed)}
      <input
        type="range"
        min={low}
        max={high}
        step={10}
        value={dragged ?? speed}
        onInput={(event) => setDragged(Number(event.currentTarget.value))}
        onChange={(event) => {
          setDragged(null);
          replaceQuery({ rpm: event.currentTarget.value });
        }}
      />
    </label>
  );
}

function OrbitPlots({ found, other }: OrbitsAndOverlay) {
  const all = [...found.orbits, ...(other?.orbits ?? [])];
  const ring = niceStep(Math.max(1e-6, ...all.map((one) => one.semi_major_um)) / 2);
  return (
    <>
      <p class="muted">
        x to the right, y up; 0-to-peak, rings of {number(ring)} µm; {slowRollOf(found)}. The dot marks the keyphasor event; the
        gap before it shows the direction of motion.
      </p>
      <div class="orbits shapes">
        {found.orbits.map((one) => (
          <OrbitPlot
            key={one.channels.join()}
            orbit={one}
            overlay={other?.orbits.find((them) => them.channels.join() === one.channels.join())}
            ring={ring}
          />
        ))}
      </div>
      {found.orbits.length === 0 && <Empty>No station has probes in both axes.</Empty>}
      {found.without.length > 0 && (
        <p class="muted">No orbit, for want of a second axis or a good sample: {found.without.map((one) => one.join(" and ")).join("; ")}.</p>
      )}
      {found.findings.map((one) => (
        <p key={one.code + one.channels.join()}>{one.words}</p>
      ))}
    </>
  );
}

/** Names only channels of which an orbit is shown. */
function slowRollOf(found: Orbits): string {
  const channels = found.orbits.flatMap((one) => one.channels);
  return slowRollText(found.slow_roll_version, channels.filter((one) => one in found.slow_roll_left_out));
}
