// The response of a chosen run, another one overlaid, at chosen channels.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { ErrorMessage, Loading, StaleNotice } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { RunSelect } from "../components/run-select";
import type { ApiError } from "../data/http-client";
import { useLastComplete } from "../data/last-complete";
import { useResource, type QueryResult } from "../data/resource";
import { useRunIdentification } from "../data/run-identification";
import { useRunSelection } from "../data/run-selection";
import { speedSweep } from "../data/speed-sweep";
import { ResponsePanels } from "../identification/response-panels";
import type { Document } from "../schemas/machines";
import type { Bode } from "../schemas/model";
import type { Phasors, Run } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

/** Channels shown where none was chosen. */
const FIRST_CHANNELS = 2;
const LIVE_POLL_MS = 1500;
/** Enough for the sharpest resonance of a train. */
const FITTED_POINTS = 600;
const NO_FIT = "This run has no accepted identification: there is no curve and no residual.";
const NOT_LOADED = "The curve of this run's identification could not be loaded.";
const UNKNOWN = "Whether this run was identified is unknown: there is no curve yet.";

export function ResponseTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const runs = useRunSelection(machine.id);
  const { run, reference } = runs;
  const { measured, complete, failures } = useResponse(machine.id, run, reference);
  if (runs.all?.length === 0) {
    return (
      <Panel title="Bode and polar">
        <Empty>No run yet. A run begins when the speed sweeps through the machine's range.</Empty>
      </Panel>
    );
  }
  const channels = machine.probes.map((one) => one.id);
  const named = (query.get("channels") ?? "").split(",").filter((one) => channels.includes(one));
  const chosen = named.length > 0 ? named : channels.slice(0, FIRST_CHANNELS);
  return (
    <>
      <Panel title="Selection">
        <div class="choices">
          <RunSelect {...runs} />
          <ChannelButtons channels={channels} chosen={chosen} />
        </div>
      </Panel>
      {!run && runs.failure && <p class="error" role="alert">{runs.failure}</p>}
      {failures.map((one) => one?.isLocal && <ErrorMessage failure={one} />)}
      <StaleNotice result={measured} />
      {!run && runs.failure ? null : complete ? (
        <ResponsePanels
          key={run?.id}
          machine={machine}
          channels={chosen}
          measured={speedSweep(complete.measured)}
          reference={complete.overlaid === reference?.id && complete.other ? speedSweep(complete.other) : undefined}
          fit={complete.fit}
          noFit={complete.noFit}
          slowRoll={slowRollOf(complete.measured, chosen)}
        />
      ) : (
        <Loading height="720px" />
      )}
    </>
  );
}

interface CompleteResponse {
  measured: Phasors;
  other: Phasors | undefined;
  /** The run that `other` is of. */
  overlaid: number | undefined;
  fit: Bode | undefined;
  noFit: string;
}

interface Response {
  measured: QueryResult<Phasors>;
  /** The last response of the run of which every part was loaded. */
  complete: CompleteResponse | undefined;
  failures: (ApiError | undefined)[];
}

/** The phasors of a run and of the one overlaid, without the same slow roll, and the curve of the run's identification. */
function useResponse(machine: string, run: Run | undefined, reference: Run | undefined): Response {
  const { identified, slowRoll, failure } = useRunIdentification(machine, run);
  const phasorsPath = (of: Run | undefined) => (of && slowRoll ? `/runs/${of.id}/phasors?slow_roll=${slowRoll}` : null);
  const measured = useResource<Phasors>(phasorsPath(run), run?.state === "open" ? LIVE_POLL_MS : 0);
  const other = useResource<Phasors>(phasorsPath(reference));
  const fit = useResource<Bode>(identified && run ? `/identifications/${identified.id}/bode?run=${run.id}&points=${FITTED_POINTS}` : null);
  const isComplete = (!identified || fit.data || fit.failure) && (!reference || other.data || other.failure);
  const noFit = identified ? NOT_LOADED : failure ? UNKNOWN : NO_FIT;
  const now = measured.data && isComplete ? { measured: measured.data, other: other.data, overlaid: reference?.id, fit: fit.data, noFit } : undefined;
  return {
    measured,
    complete: useLastComplete<CompleteResponse>(run?.id, now),
    failures: [failure, measured.data ? undefined : measured.failure, other.failure, fit.failure],
  };
}

function slowRollOf(measured: Phasors, chosen: string[]): string {
  return slowRollText(measured.slow_roll_version, chosen.filter((one) => one in measured.slow_roll_left_out));
}

function ChannelButtons({ channels, chosen }: { channels: string[]; chosen: string[] }) {
  const toggle = (one: string) => {
    const next = channels.filter((other) => (other === one) !== chosen.includes(other));
    if (next.length > 0) replaceQuery({ channels: next.join(",") });
  };
  return (
    <span class="buttons" role="group" aria-label="Channels">
      {channels.map((one) => (
        <button key={one} type="button" aria-pressed={chosen.includes(one)} onClick={() => toggle(one)}>
          {one}
        </button>
      ))}
    </span>
  );
}
