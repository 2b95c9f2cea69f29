// A balancing proposal from an identified model.
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Scroll } from "../components/scroll";
import { useResource } from "../data/resource";
import { angleConvention } from "../format/angles";
import { number } from "../format/numbers";
import { t } from "../messages/messages";
import type { Balancing } from "../schemas/model";

export function BalancingPanel({ path }: { path: string }) {
  const result = useResource<Balancing>(path);
  return (
    <Panel title={t("balancingProposal")} aside={<p class="muted">{t("unbalanceToAddFromThe")}</p>}>
      <Loaded result={result} lines={8}>
        {(found) => (
          <div class="columns">
            <Corrections found={found} />
            <Amplitudes found={found} />
          </div>
        )}
      </Loaded>
    </Panel>
  );
}

function Corrections({ found }: { found: Balancing }) {
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("plane")}</th>
            <th class="number">{t("correction")}</th>
            <th class="number">{t("angleCounted", { convention: angleConvention(found.direction) })}</th>
          </tr>
        </thead>
        <tbody>
          {found.corrections.map((one) => (
            <tr key={one.plane}>
              <td>{one.plane}</td>
              <td class="number">{number(one.unbalance_g_mm)} g·mm</td>
              <td class="number">{Math.round(one.angle_deg) % 360}°</td>
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function Amplitudes({ found }: { found: Balancing }) {
  const { amplitude } = useUnits();
  const amplitudeText = (um: number) => `${number(um * amplitude.factor)} ${amplitude.label}`;
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{t("channel")}</th>
            <th class="number">{t("largestBefore")}</th>
            <th class="number">{t("largestAfter95")}</th>
          </tr>
        </thead>
        <tbody>
          {found.before.map((one, at) => (
            <tr key={one.channel}>
              <td>{one.channel}</td>
              <td class="number">{amplitudeText(largest(one.amplitude))}</td>
              <td class="number">{t("belowAmplitude", { upper: amplitudeText(largest(found.after[at]?.upper ?? [])) })}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function largest(column: (number | null)[]): number {
  return Math.max(0, ...column.map((one) => one ?? 0));
}
