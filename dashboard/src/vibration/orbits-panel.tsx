// The orbits at the probes, of 1× alone or with the 2×, at a chosen speed of a run: at first at running speed.
import { useState } from "preact/hooks";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { useUnits } from "../browser/units";
import { ErrorMessage, Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { RunSelect } from "../components/run-select";
import { Speed, useSpeedText } from "../components/speed";
import type { ApiError } from "../data/http-client";
import { useLastComplete } from "../data/last-complete";
import { useResource, type QueryResult } from "../data/resource";
import { useRunIdentification } from "../data/run-identification";
import { useRunSelection } from "../data/run-selection";
import { number } from "../format/numbers";
import { rich, stored, t } from "../messages/messages";
import { niceStep } from "../plots/axis-steps";
import { OrbitPlot } from "../plots/orbit-plot";
import type { Document } from "../schemas/machines";
import type { AxisPhasor, Orbit, Orbits, Run } from "../schemas/runs";
import { slowRollText } from "../words/slow-roll";

interface OrbitsAndOverlay {
  found: Orbits;
  other: Orbits | undefined;
}

export function OrbitsPanel({ machine }: { machine: Document }) {
  const runs = useRunSelection(machine.id);
  const { query } = useStore(route);
  const { minimum_rpm: low, maximum_rpm: high } = machine.speed_range;
  const speed = Number(query.get("rpm")) || runningSpeed(machine, runs.run);
  const second = query.get("order") === "2";
  const { result, failure } = useOrbits(machine.id, runs.run, runs.reference, speed);
  return (
    <Panel title={t("orbitsAtProbes", { orders: second ? t("n1And2") : "1×" })}>
      <div class="choices">
        <RunSelect {...runs} />
        <SpeedSlider low={low} high={high} speed={speed} />
        <label class="switch">
          <input type="checkbox" checked={second} onChange={(event) => replaceQuery({ order: event.currentTarget.checked ? "2" : null })} />
          {t("with2")}
        </label>
      </div>
      {failure?.isLocal && <ErrorMessage failure={failure} />}
      {runs.all?.length === 0 ? (
        <Empty>{t("noRunYet")}</Empty>
      ) : !runs.run && runs.failure ? (
        <p class="error" role="alert">
          {runs.failure}
        </p>
      ) : (
        <Loaded result={result} lines={20}>
          {({ found, other }) => <OrbitPlots found={found} other={other} second={second} />}
        </Loaded>
      )}
    </Panel>
  );
}

/** The speed at which the machine works; else the run's highest. */
export function runningSpeed({ operation, speed_range: range }: Document, run: Run | undefined): number {
  return Math.round(operation?.running_rpm ?? run?.speed_maximum_rpm ?? range.maximum_rpm);
}

/** The orbits of a run and of the one overlaid, without the same slow roll, once both are loaded. */
export function useOrbits(machine: string, run: Run | undefined, reference: Run | undefined, speed: number): { result: QueryResult<OrbitsAndOverlay>; failure: ApiError | undefined } {
  const { slowRoll, failure } = useRunIdentification(machine, run);
  const orbitsPath = (of: Run | undefined) => (of && slowRoll ? `/runs/${of.id}/orbits?rpm=${speed}&slow_roll=${slowRoll}` : null);
  const found = useResource<Orbits>(orbitsPath(run));
  const other = useResource<Orbits>(orbitsPath(reference));
  const isComplete = !reference || other.data || other.failure;
  const now = found.data && isComplete ? { found: found.data, other: other.data } : undefined;
  const complete = useLastComplete<OrbitsAndOverlay>([run?.id, reference?.id, speed].join(), now);
  return { result: { ...found, data: found.data || !found.failure?.isLocal ? complete : undefined }, failure: failure ?? other.failure };
}

/** The speed is shown while it is dragged, and chosen when it is let go. */
function SpeedSlider({ low, high, speed }: { low: number; high: number; speed: number }) {
  const [dragged, setDragged] = useState<number | null>(null);
  return (
    <label class="wide">
      {rich("speedChosen", { speed: <Speed rpm={dragged ?? speed} /> })}
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

export function OrbitPlots({ found, other, second }: OrbitsAndOverlay & { second: boolean }) {
  const { amplitude } = useUnits();
  const speedText = useSpeedText();
  const all = [...found.orbits, ...(other?.orbits ?? [])];
  const reach = (one: Orbit) => one.semi_major_um + (second && one.x_2x && one.y_2x ? size(one.x_2x, one.y_2x) : 0);
  const shown = niceStep(Math.max(1e-6, ...all.map(reach)) * amplitude.factor);
  return (
    <>
      <p class="muted">
        {t("orbitReading", { width: number(2 * shown), unit: amplitude.label, slow_roll: slowRollOf(found) })}
      </p>
      <div class="orbits shapes">
        {found.orbits.map((one) => (
          <OrbitPlot
            key={one.channels.join()}
            orbit={one}
            overlay={other?.orbits.find((them) => them.channels.join() === one.channels.join())}
            ring={shown / amplitude.factor}
            second={second}
            unit={amplitude}
            speed={speedText}
          />
        ))}
      </div>
      {found.orbits.length === 0 && <Empty>{t("noStationHasProbesIn")}</Empty>}
      {found.without.length > 0 && (
        <p class="muted">{t("noOrbitFor", { channels: found.without.map((one) => one.join(t("and"))).join("; ") })}</p>
      )}
      {found.findings.map((one) => (
        <p key={one.code + one.channels.join()}>{stored(one.words)}</p>
      ))}
    </>
  );
}

function size(...axes: AxisPhasor[]): number {
  return Math.hypot(...axes.flatMap((one) => [one.real_um, one.imaginary_um]));
}

/** Names only channels of which an orbit is shown. */
function slowRollOf(found: Orbits): string {
  const channels = found.orbits.flatMap((one) => one.channels);
  return slowRollText(found.slow_roll_version, channels.filter((one) => one in found.slow_roll_left_out));
}
