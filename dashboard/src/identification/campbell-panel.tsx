// The Campbell diagram of an identified model.
import { speedsInUnit, useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { useSpeedText } from "../components/speed";
import { useResource } from "../data/resource";
import { isBackward } from "../format/angles";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { Curve } from "../plots/plot-props";
import type { Document } from "../schemas/machines";
import type { Campbell } from "../schemas/model";

/** Modes with a higher damping ratio have no noticeable resonance, and are omitted. */
const HEAVILY_DAMPED = 0.5;

export function CampbellPanel({ machine, path }: { machine: Document; path: string }) {
  const result = useResource<Campbell>(path);
  const { speed } = useUnits();
  const speedText = useSpeedText();
  return (
    <Panel title={t("campbellDiagram")} aside={<p class="muted">{t("naturalFrequenciesOverSpeedDotted")}</p>}>
      <Loaded result={result} lines={24}>
        {(found) => (
          <Plot
            label={t("campbellDiagramWithModes", { count: found.curves.length })}
            x={speedsInUnit(found.speed, speed)}
            xUnit={speed.label}
            yUnit="Hz"
            height={380}
            curves={curvesOf(found)}
            markers={found.critical_speeds.map((one) => ({ x: one.speed * speed.factor, kind: "speed" as const, words: t("criticalSpeedMarker") }))}
            readOut={(index) => `${speedText(found.speed[index])}: ${frequenciesText(found, index)}`}
          />
        )}
      </Loaded>
      <p class="muted">
        {t("campbellLines", { speed: speedText(machine.speed_range.maximum_rpm) })}
      </p>
    </Panel>
  );
}

function curvesOf(found: Campbell): Curve[] {
  const modes = found.curves.flatMap((one, at): Curve[] => {
    const y = one.frequency_hz.map((value, index) => ((one.damping_ratio[index] ?? 1) < HEAVILY_DAMPED ? value : null));
    if (y.every((value) => value === null)) return [];
    const whirl = one.whirl.reduce<number>((sum, value) => sum + (value ?? 0), 0) / one.whirl.length;
    return [{ name: t("modeNumber", { number: at + 1 }), style: isBackward(whirl) ? 1 : 0, y, unlisted: true }];
  });
  return [{ name: "1×", style: 2, y: found.synchronous_hz, unlisted: true }, ...modes];
}

function frequenciesText(found: Campbell, index: number): string {
  const frequencies = found.curves
    .map((one) => ({ hz: one.frequency_hz[index], damping: one.damping_ratio[index] }))
    .filter((one) => one.hz !== null && one.hz !== undefined && (one.damping ?? 1) < HEAVILY_DAMPED)
    .map((one) => `${number(one.hz)}`);
  return `${frequencies.join(", ")} Hz`;
}
