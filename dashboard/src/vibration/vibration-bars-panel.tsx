// The newest overall level, 1×, 2× and gap at each probe as bars beside the machine's limits.
import type { DataColumn } from "../browser/download";
import { useUnits, type Unit } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Speed } from "../components/speed";
import { Time } from "../components/time";
import { useResource } from "../data/resource";
import { number } from "../format/numbers";
import { when } from "../format/times";
import { rich, t, term } from "../messages/messages";
import { SavePicture } from "../plots/save-buttons";
import type { Document } from "../schemas/machines";
import type { ProbeVibration, Vibration, VibrationLimits } from "../schemas/vibration";
import { slowRollText } from "../words/slow-roll";
import { LEVEL_SIGNS, limitsText, vibrationLevel, zoneBoundaries, zonesText } from "../words/vibration-limits";
import { barsPicture, type PictureLine } from "./bars-picture";

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
            <div class="bars">
              <ol class="vibration-bars">
                {found.probes.map((one) => (
                  <Bar key={one.channel} probe={one} limits={found.limits} full={fullScale(found)} fullGap={largestGap(found)} unit={amplitude} />
                ))}
              </ol>
            </div>
            <p class="muted">
              {signs(found)}; {slowRollText(found.slow_roll_version, Object.keys(found.slow_roll_left_out))}. {limitsText(found.limits, amplitude)}{" "}
              {zonesText(found.limits.severity_zones, amplitude)}
              {found.probes.some((one) => one.gap_um !== null) && ` ${t("gapsExplained")}`}
            </p>
          </>
        )}
      </Loaded>
    </Panel>
  );
}

/** When the newest of them was measured, and how fast the shaft turned. */
function Newest({ found }: { found: Vibration | undefined }) {
  const { amplitude } = useUnits();
  const newest = found?.probes.reduce<ProbeVibration | undefined>((one, other) => ((one?.time ?? "") > (other.time ?? "") ? one : other), undefined);
  if (!found || !newest?.time) return null;
  const { time } = newest;
  return (
    <div class="muted">
      {rich("at", { time: <Time at={time} />, speed: <Speed rpm={newest.speed_rpm} /> })}{" "}
      <SavePicture label={t("vibrationAtTheProbes")} columns={() => columnsOf(found.probes)} picture={() => pictureOf(found, when(time), amplitude)} />
    </div>
  );
}

function signs({ probes }: Vibration): string {
  const overall = probes.some((one) => one.overall_um_pp !== null) ? [t("overallSign")] : [];
  return ["█ 1×", "▒ 2×", ...overall].join(", ");
}

function fullScale({ probes, limits }: Vibration): number {
  const sizes = probes.flatMap((one) => [one.first?.amplitude_um_pp ?? 0, one.second?.amplitude_um_pp ?? 0, one.overall_um_pp ?? 0]);
  return HEADROOM * Math.max(1e-9, ...sizes, limits.alert_um_pp ?? 0, limits.danger_um_pp ?? 0, limits.severity_zones?.c_d_um_pp ?? 0);
}

function largestGap({ probes }: Vibration): number {
  return HEADROOM * Math.max(1e-9, ...probes.map((one) => Math.abs(one.gap_um ?? 0)));
}

interface BarProps {
  probe: ProbeVibration;
  limits: VibrationLimits;
  /** Values of the longest bar [µm pp] and of the longest bar of a gap [µm]. */
  full: number;
  fullGap: number;
  unit: Unit;
}

function Bar({ probe, limits, full, fullGap, unit }: BarProps) {
  const { channel, first, second, overall_um_pp: overall, gap_um: gap } = probe;
  const level = vibrationLevel(first?.amplitude_um_pp, limits);
  const part = (value: number) => `${((100 * value) / full).toFixed(2)}%`;
  return (
    <li class={level} data-channel={channel}>
      <strong>
        <span aria-hidden="true">{LEVEL_SIGNS[level]}</span> {channel}
      </strong>
      <span class="gauge" aria-hidden="true">
        {first && <span class="first" style={{ width: part(first.amplitude_um_pp) }} />}
        {second && <span class="second" style={{ width: part(second.amplitude_um_pp) }} />}
        {overall !== null && <span class="overall" style={{ width: part(overall) }} />}
        {overall !== null && zoneBoundaries(limits.severity_zones).map(([name, value]) => <span key={name} class="boundary" style={{ left: part(value) }} />)}
        {limits.alert_um_pp !== null && <span class="limit alert" style={{ left: part(limits.alert_um_pp) }} />}
        {limits.danger_um_pp !== null && <span class="limit danger" style={{ left: part(limits.danger_um_pp) }} />}
      </span>
      <span class="told">
        {probeText(probe, unit)}
        {(level === "alert" || level === "danger") && <span class="hidden">: {term(level)}</span>}
      </span>
      {gap !== null && <Gap gap={gap} full={fullGap} />}
    </li>
  );
}

function probeText({ time, first, second, overall_um_pp: overall, zone }: ProbeVibration, unit: Unit): string {
  const amplitudeText = (value: number) => `${number(value * unit.factor)} ${unit.label}`;
  const parts = [
    first ? t("firstOrderText", { amplitude: amplitudeText(first.amplitude_um_pp), lag: Math.round(first.phase_lag_deg) % 360 }) : t(time === null ? "nothingMeasuredYet" : "noGoodValue"),
    ...(second ? [`2× ${amplitudeText(second.amplitude_um_pp)}`] : []),
    ...(overall === null ? [] : [t("overallText", { amplitude: amplitudeText(overall) })]),
  ];
  return parts.join("; ") + (zone ? t("inZone", { zone }) : "");
}

function pictureOf(found: Vibration, time: string, unit: Unit): string {
  const full = fullScale(found);
  const part = (value: number | null | undefined) => (value === null || value === undefined ? null : value / full);
  const bars = found.probes.map((one) => ({
    channel: one.channel,
    level: vibrationLevel(one.first?.amplitude_um_pp, found.limits),
    reading: probeText(one, unit),
    first: part(one.first?.amplitude_um_pp),
    second: part(one.second?.amplitude_um_pp),
    overall: part(one.overall_um_pp),
  }));
  const { alert_um_pp: alert, danger_um_pp: danger, severity_zones: zones } = found.limits;
  const hasOverall = found.probes.some((one) => one.overall_um_pp !== null);
  const lines: PictureLine[] = [
    ...(alert === null ? [] : [{ at: alert / full, kind: "alert" as const }]),
    ...(danger === null ? [] : [{ at: danger / full, kind: "danger" as const }]),
    ...(hasOverall ? zoneBoundaries(zones).map(([, value]) => ({ at: value / full, kind: "boundary" as const })) : []),
  ];
  return barsPicture(`${t("vibrationAtTheProbes")}, ${time}`, bars, lines, `${signs(found)}. ${limitsText(found.limits, unit)}`);
}

/** The place of the shaft at a probe that sends gaps, from a zero of the probe's own; full: the longest bar. */
function Gap({ gap, full }: { gap: number; full: number }) {
  const { length } = useUnits();
  return (
    <span class="gap-of">
      <span>{t("gapText", { gap: `${number(gap * length.factor, 4)} ${length.label}` })}</span>
      <span class="gauge" aria-hidden="true">
        <span class="first" style={{ width: `${((100 * Math.abs(gap)) / full).toFixed(2)}%` }} />
      </span>
    </span>
  );
}

function columnsOf(probes: ProbeVibration[]): DataColumn[] {
  return [
    { name: t("csvChannel"), values: probes.map((one) => one.channel) },
    { name: t("csvTime"), values: probes.map((one) => one.time) },
    { name: t("csvSpeedIn", { unit: t("rpm") }), values: probes.map((one) => one.speed_rpm) },
    { name: "1× [µm pp]", values: probes.map((one) => one.first?.amplitude_um_pp ?? null) },
    { name: t("csvLag", { order: "1×" }), values: probes.map((one) => one.first?.phase_lag_deg ?? null) },
    { name: "2× [µm pp]", values: probes.map((one) => one.second?.amplitude_um_pp ?? null) },
    { name: t("csvLag", { order: "2×" }), values: probes.map((one) => one.second?.phase_lag_deg ?? null) },
    { name: t("csvOverall"), values: probes.map((one) => one.overall_um_pp) },
    { name: t("csvZone"), values: probes.map((one) => one.zone) },
    { name: t("csvGap"), values: probes.map((one) => one.gap_um) },
  ];
}
