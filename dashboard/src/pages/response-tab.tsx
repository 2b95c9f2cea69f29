// Choosing a run, one beside it, and channels, for the Bode and polar plots.
import type { Bode, Document, Phasors } from "../schemas/answers";
import { Response } from "../panels/response-panels";
import { slowRollWords, useFitOf } from "../data/run-identification";
import { useLastWhole } from "../data/last-complete";
import { Aging, Empty, Panel, Trouble } from "../components/parts";
import { useResource } from "../data/resource";
import { choose, place } from "../browser/router";
import { RunChoice, useRuns } from "../data/run-selection";
import { useStore } from "../browser/store";
import { bySpeed } from "../data/speed-sweep";

/** So many channels at once where none was chosen. */
const FIRST_CHANNELS = 2;
const LIVE_MS = 1500;
/** Enough for the sharpest resonance of a train. */
const FITTED_POINTS = 600;
const NO_FIT = "This run has no accepted identification: there is no curve and nothing is left over.";
const NOT_THERE = "The curve of this run's identification could not be had.";
const NOT_KNOWN = "Whether this run was identified is not known: there is no curve yet.";

export function ResponseView({ machine }: { machine: Document }) {
  const asked = useStore(place).query;
  const runs = useRuns(machine.id);
  const { run, reference } = runs;
  const { identified, slowRoll, failure } = useFitOf(machine.id, run);
  const without = (of: number) => (slowRoll ? `/runs/${of}/phasors?slow_roll=${slowRoll}` : null);
  const measured = useResource<Phasors>(run ? without(run.id) : null, run?.state === "open" ? LIVE_MS : 0);
  const other = useResource<Phasors>(reference ? without(reference.id) : null);
  const fit = useResource<Bode>(identified && run ? `/identifications/${identified.id}/bode?run=${run.id}&points=${FITTED_POINTS}` : null);
  const isWhole = (!identified || fit.data || fit.failure) && (!reference || other.data || other.failure);
  const noFit = identified ? NOT_THERE : failure ? NOT_KNOWN : NO_FIT;
  const whole = useLastWhole(run?.id, measured.data && isWhole ? { measured: measured.data, other: other.data, beside: reference?.id, fit: fit.data, noFit } : undefined);
  if (runs.all?.length === 0) {
    return (
      <Panel title="Bode and polar">
        <Empty>No run yet. One begins when the speed sweeps through the machine's range.</Empty>
      </Panel>
    );
  }
  const channels = machine.probes.map((one) => one.id);
  const named = (asked.get("channels") ?? "").split(",").filter((one) => channels.includes(one));
  const chosen = named.length > 0 ? named : channels.slice(0, FIRST_CHANNELS);
  return (
    <>
      <Panel title="What is shown">
        <div class="choices">
          <RunChoice {...runs} />
          <Channels channels={channels} chosen={chosen} />
        </div>
      </Panel>
      {!run && runs.failure && <p class="trouble" role="alert">{runs.failure}</p>}
      {[failure, measured.data ? undefined : measured.failure, other.failure, fit.failure].map((one) => one?.own && <Trouble failure={one} />)}
      <Aging answer={measured} />
      {!run && runs.failure ? null : whole ? (
        <Response
          key={run?.id}
          machine={machine}
          channels={chosen}
          measured={bySpeed(whole.measured)}
          reference={whole.beside === reference?.id && whole.other ? bySpeed(whole.other) : undefined}
          fit={whole.fit}
          noFit={whole.noFit}
          slowRoll={slowRollOf(whole.measured, chosen)}
        />
      ) : (
        <div class="waiting" style={{ minHeight: "720px" }} />
      )}
    </>
  );
}

function slowRollOf(measured: Phasors, chosen: string[]): string {
  return slowRollWords(measured.slow_roll_version, chosen.filter((one) => one in measured.slow_roll_left_out));
}

function Channels({ channels, chosen }: { channels: string[]; chosen: string[] }) {
  const toggle = (one: string) => {
    const next = channels.filter((other) => (other === one) !== chosen.includes(other));
    if (next.length > 0) choose({ channels: next.join(",") });
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
