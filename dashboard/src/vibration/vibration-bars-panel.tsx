// The newest 1× and 2× at each probe as bars, beside the machine's limits.
import { useUnits, type Unit } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { number } from "../format/numbers";
import { rich, t, term } from "../messages/messages";
import type { Document } from "../schemas/machines";
import type { ProbeVibration, Vibration, VibrationLimits } from "../schemas/vibration";
import { slowRollText } from "../words/slow-roll";
import { LEVEL_SIGNS, limitsText, vibrationLevel } from "../words/vibration-limits";

const POLL_MS = 2000;
/** The longest bar ends before the panel does. */
const HEADROOM = 1.08;

export function VibrationBarsPanel({ machine }: { machine: Document }) {
  const { amplitude } = useUnits();
  const result = useResource<Vibration>(`/machines/${machine.id}/vibration?slow_roll=in_force`, POLL_MS);
  return (
    <Panel title={t("vibrationAtTheProbes")} aside={<Newest found={result.data} />}>
      <Loaded result={result} lines={machine.probes.length + 2}>
        {(found) => (
          <>
            <ol class="vibration-bars">
              {found.probes.map((one) => (
                <Bar key={one.channel} probe={one} limits={found.limits} full={fullScale(found)} unit={amplitude} />
              ))}
            </ol>
            <p class="muted">
              █ 1×, ▒ 2×; {slowRollText(found.slow_roll_version, Object.keys(found.slow_roll_left_out))}. {limitsText(found.limits, amplitude)}
            </p>
          </>
        )}
      </Loaded>
    </Panel>
  );
}

/** When the newest of them was measured, and how fast the shaft turned. */
function Newest({ found }: { found: Vibration | undefined }) {
  const newest = found?.probes.reduce<ProbeVibration | undefined>((one, other) => ((one?.time ?? "") > (other.time ?? "") ? one : other), undefined);
  if (!newest?.time) return null;
  return (
    <p class="muted">
      {rich("at", { time: <Time at={newest.time} />, speed: <Speed rpm={newest.speed_rpm} /> })}
    </p>
  );
}

function fullScale({ probes, limits }: Vibration): number {
  const sizes = probes.flatMap((one) => [one.first?.amplitude_um_pp ?? 0, one.second?.amplitude_um_pp ?? 0]);
  return HEADROOM * Math.max(1e-9, ...sizes, limits.alert_um_pp ?? 0, limits.danger_um_pp ?? 0);
}

function Bar({ probe, limits, full, unit }: { probe: ProbeVibration; limits: VibrationLimits; full: number; unit: Unit }) {
  const { channel, first, second } = probe;
  const level = vibrationLevel(first?.amplitude_um_pp, limits);
  const part = (value: number) => `${((100 * value) / full).toFixed(2)}%`;
  const told = (value: number) => `${number(value * unit.factor)} ${unit.label}`;
  return (
    <li class={level} data-channel={channel}>
      <strong>
        <span aria-hidden="true">{LEVEL_SIGNS[level]}</span> {channel}
      </strong>
      <span class="gauge" aria-hidden="true">
        {first && <span class="first" style={{ width: part(first.amplitude_um_pp) }} />}
        {second && <span class="second" style={{ width: part(second.amplitude_um_pp) }} />}
        {limits.alert_um_pp !== null && <span class="limit alert" style={{ left: part(limits.alert_um_pp) }} />}
        {limits.danger_um_pp !== null && <span class="limit danger" style={{ left: part(limits.danger_um_pp) }} />}
      </span>
      <span class="told">
        {first ? t("firstOrderText", { amplitude: told(first.amplitude_um_pp), lag: Math.round(first.phase_lag_deg) % 360 }) : t("noGoodValue")}
        {second && `; 2× ${told(second.amplitude_um_pp)}`}
        {(level === "alert" || level === "danger") && <span class="hidden">: {term(level)}</span>}
      </span>
    </li>
  );
}
