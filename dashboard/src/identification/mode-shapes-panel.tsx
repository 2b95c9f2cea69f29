// The mode shapes of the newest identified model.
import { NewestNotice, NoIdentification, PendingPanel } from "../components/newest-identification";
import { Loaded } from "../components/loading";
import { Empty, Panel } from "../components/panel";
import { Speed } from "../components/speed";
import { useNewestIdentification } from "../data/newest-identification";
import { useResource } from "../data/resource";
import { rich, t } from "../messages/messages";
import { ModeShapePlot } from "../plots/mode-shape-plot";
import type { Document, Drawing } from "../schemas/machines";
import type { Modes, ModeShape } from "../schemas/model";

const MAX_MODES = 8;
/** Modes with a higher damping ratio have no visible shape. */
const OVERDAMPED = 0.9;

function modesPath(id: number): string {
  return `/identifications/${id}/model/modes`;
}

export function ModeShapesPanel({ machine }: { machine: Document }) {
  const { newest, none, failure, list } = useNewestIdentification(machine.id, (id) => [modesPath(id)]);
  const result = useResource<Modes>(newest ? modesPath(newest.id) : null);
  const drawing = useResource<Drawing>(`/machines/${machine.id}/drawing`).data;
  if (none) return <NoIdentification />;
  if (!newest) return <PendingPanel title={t("modeShapes")} failure={failure} />;
  return (
    <Panel title={t("modeShapesOfIdentification", { id: newest.id })} aside={<p class="muted">{t("modeShapeLines")}</p>}>
      <NewestNotice failure={failure} list={list} />
      <Loaded result={result} lines={20}>
        {(found) => (
          <>
            <p class="muted">{rich("modeShapesAt", { speed: <Speed rpm={found.speed} /> })}</p>
            {found.modes.length === 0 && <Empty>{t("noModeUpToTwice")}</Empty>}
            <Omitted modes={found.modes} />
            <div class="modes shapes">
              {drawing &&
                found.modes
                  .filter(isVisible)
                  .slice(0, MAX_MODES)
                  .map((mode) => <ModeShapePlot key={mode.frequency_hz} mode={mode} drawing={drawing} />)}
            </div>
          </>
        )}
      </Loaded>
    </Panel>
  );
}

function isVisible(mode: ModeShape): boolean {
  return mode.damping_ratio < OVERDAMPED;
}

/** State which modes are not shown. */
function Omitted({ modes }: { modes: ModeShape[] }) {
  const visible = modes.filter(isVisible).length;
  const overdamped = modes.length - visible;
  return (
    <>
      {visible > MAX_MODES && <p class="muted truncated">{t("lowestModesShown", { shown: MAX_MODES, all: visible })}</p>}
      {overdamped > 0 && <p class="muted truncated">{overdamped === 1 ? t("oneOverdamped", { limit: 100 * OVERDAMPED }) : t("manyOverdamped", { count: overdamped, limit: 100 * OVERDAMPED })}</p>}
    </>
  );
}
