// The critical speeds of an identified model.
import { useUnits, type Unit } from "../browser/units";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { Speed, useSpeedText } from "../components/speed";
import { useResource } from "../data/resource";
import { whirlName } from "../format/angles";
import { decimal, number } from "../format/numbers";
import { t } from "../messages/messages";
import type { Document } from "../schemas/machines";
import type { CriticalSpeed, CriticalSpeeds } from "../schemas/model";

export function CriticalSpeedsPanel({ machine, path }: { machine: Document; path: string }) {
  const result = useResource<CriticalSpeeds>(path);
  const speedText = useSpeedText();
  return (
    <Panel title={t("criticalSpeeds")} aside={<p class="muted">{t("with95Intervals")}</p>}>
      <Loaded result={result} lines={10}>
        {(found) =>
          found.critical_speeds.length === 0 ? (
            <Empty>{t("noneUpTo", { speed: speedText(found.highest) })}</Empty>
          ) : (
            <Scroll label={t("table")}>
              <table>
                <thead>
                  <tr>
                    <th class="number">{t("speed")}</th>
                    <th class="number">{t("interval")}</th>
                    <th class="number">{t("dampingRatio")}</th>
                    <th class="number">{t("logDecrement")}</th>
                    <th>{t("whirl")}</th>
                    <th>{t("position")}</th>
                  </tr>
                </thead>
                <tbody>
                  {found.critical_speeds.map((one) => (
                    <CriticalSpeedRow key={one.speed} one={one} machine={machine} />
                  ))}
                </tbody>
              </table>
            </Scroll>
          )
        }
      </Loaded>
    </Panel>
  );
}

/** Text with as many digits as distinguish the interval's ends. */
function bound(value: number | null, { lower, upper }: CriticalSpeed, { factor }: Unit): string {
  if (value === null) return "–";
  const width = lower === null || upper === null ? Infinity : (upper - lower) * factor;
  const digits = width < 0.2 ? 2 : width < 2 || factor !== 1 ? 1 : 0;
  return decimal((value * factor).toFixed(digits));
}

function CriticalSpeedRow({ one, machine }: { one: CriticalSpeed; machine: Document }) {
  const { minimum_rpm: low, maximum_rpm: high } = machine.speed_range;
  const { speed } = useUnits();
  return (
    <tr>
      <td class="number"><Speed rpm={one.speed} /></td>
      <td class="number muted">
        {bound(one.lower, one, speed)} … {bound(one.upper, one, speed)}
      </td>
      <td class="number">{number(100 * one.damping_ratio)} %</td>
      <td class="number">{number(one.log_decrement)}</td>
      <td>{whirlName(one.whirl)}</td>
      <td>{one.speed < low ? t("belowTheRange") : one.speed > high ? t("aboveTheRange") : t("inTheRange")}</td>
    </tr>
  );
}
