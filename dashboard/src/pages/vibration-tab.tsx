// The vibration of a machine: now at every probe, and over time at running speed.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { Loading } from "../components/loading";
import { PeriodFields } from "../components/period-fields";
import { Panel } from "../components/panel";
import { usePeriod } from "../data/chosen-period";
import { t, term } from "../messages/messages";
import type { Document } from "../schemas/machines";
import { VibrationBarsPanel } from "../vibration/vibration-bars-panel";
import { VibrationTrendPanels } from "../vibration/vibration-trend-panels";
import { BesideAlert, ChannelButtons, useChosenChannels } from "./chosen-channels";

const KINDS = ["run-up", "run-down", "rolling"];

export function VibrationTab({ machine }: { machine: Document }) {
  const { query } = useStore(route);
  const { chosen, beside, isPending } = useChosenChannels(machine);
  const kind = query.get("kind");
  const period = usePeriod();
  return (
    <>
      <VibrationBarsPanel machine={machine} />
      <Panel title={t("selection")}>
        <div class="choices">
          <label>
            {t("runsShown")}
            <select value={kind ?? ""} onChange={(event) => replaceQuery({ kind: event.currentTarget.value || null })}>
              <option value="">{t("ofTheNewestKind")}</option>
              {KINDS.map((one) => (
                <option key={one} value={one}>
                  {term(one)}
                </option>
              ))}
            </select>
          </label>
          <PeriodFields {...period} />
          <ChannelButtons machine={machine} chosen={chosen} />
        </div>
        <BesideAlert beside={beside} isPending={isPending} />
      </Panel>
      {isPending ? <Loading height="720px" /> : <VibrationTrendPanels machine={machine} channels={chosen} kind={kind} from={period.from} to={period.to} />}
    </>
  );
}
