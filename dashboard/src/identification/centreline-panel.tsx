// The shaft centreline of an identified train on oil films: the model's line in each clearance circle, and what gaps measured.
import { speedsInUnit, useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { t } from "../messages/messages";
import { CentrelinePlot, type JournalLine } from "../plots/centreline-plot";
import { CurveLegend } from "../plots/curve-legend";
import type { Identification } from "../schemas/identifications";
import type { Document } from "../schemas/machines";
import type { Centreline } from "../schemas/model";
import { oilFilms } from "../words/oil-films";

/** Nothing where the identification tells of no films. */
export function CentrelinePanel({ machine, found, path }: { machine: Document; found: Identification; path: string }) {
  const hasFilms = oilFilms(found, machine).length > 0;
  const result = useResource<Centreline>(hasFilms ? path : null);
  const { speed } = useUnits();
  if (!hasFilms) return null;
  return (
    <Panel title={t("shaftCentreline")} aside={<p class="muted">{t("centrelineAxes", { unit: speed.label })}</p>}>
      <Loaded result={result} lines={16}>
        {(lines) => (
          <>
            <p class="muted">
              <CurveLegend curves={namesOf(lines).map((name, style) => ({ name, style }))} /> · {measuredText(lines)}
            </p>
            <div class="orbits shapes">
              {lines.bearings.map((one) => (
                <CentrelinePlot key={one.bearing} bearing={one.bearing} clearance={one.clearance_um} lines={linesOf(lines, one.bearing, speed.factor)} speedUnit={speed.label} />
              ))}
            </div>
          </>
        )}
      </Loaded>
    </Panel>
  );
}

function namesOf({ measured }: Centreline): string[] {
  return [t("modelsLine"), ...measured.map(({ run }) => t("gapsOfRun", { run }))];
}

function measuredText({ measured }: Centreline): string {
  if (measured.length === 0) return t("noGapsInTheseRuns");
  return t("zerosSetByTheModel");
}

function linesOf(found: Centreline, bearing: string, factor: number): JournalLine[] {
  const modelled = found.bearings.find((one) => one.bearing === bearing)!;
  const unit = { label: "", factor };
  const model: JournalLine = { name: t("modelsLine"), style: 0, speed: speedsInUnit(found.speed, unit), x: modelled.x_um, y: modelled.y_um, measured: false };
  const measured = found.measured.flatMap(({ run, speed, bearings }, at): JournalLine[] => {
    const own = bearings.find((one) => one.bearing === bearing);
    return own ? [{ name: t("gapsOfRun", { run }), style: at + 1, speed: speedsInUnit(speed, unit), x: own.x_um, y: own.y_um, measured: true }] : [];
  });
  return [model, ...measured];
}
