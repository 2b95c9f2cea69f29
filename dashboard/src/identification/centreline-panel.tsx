// The shaft centreline of an identified train on oil films: the model's line in each clearance circle, what gaps measured, and
// both of an earlier identification laid over them.
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { inUnit, speedsInUnit, useUnits, type Units } from "../browser/units";
import { ErrorMessage, Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { useResource } from "../data/resource";
import { when } from "../format/times";
import { t, term } from "../messages/messages";
import { CentrelinePlot, type JournalLine } from "../plots/centreline-plot";
import { CurveLegend } from "../plots/curve-legend";
import type { Identification, IdentificationSummary } from "../schemas/identifications";
import type { Document } from "../schemas/machines";
import type { Centreline } from "../schemas/model";
import { oilFilms } from "../words/oil-films";

/** Identifications that can be laid over. */
const LIMIT = 200;

function pathOf(identification: number | string): string {
  return `/identifications/${identification}/model/centreline`;
}

/** Nothing where the identification tells of no films. */
export function CentrelinePanel({ machine, found }: { machine: Document; found: Identification }) {
  const hasFilms = oilFilms(found, machine).length > 0;
  const overlaid = useStore(route).query.get("overlay") ?? "";
  const result = useResource<Centreline>(hasFilms ? pathOf(found.id) : null);
  const other = useResource<Centreline>(hasFilms && overlaid ? pathOf(encodeURIComponent(overlaid)) : null);
  const { speed } = useUnits();
  if (!hasFilms) return null;
  return (
    <Panel title={t("shaftCentreline")} aside={<p class="muted">{t("centrelineAxes", { unit: speed.label })}</p>}>
      <div class="choices">
        <PathOverlaySelect machine={machine.id} shown={found.id} overlaid={overlaid} />
      </div>
      {other.failure?.isLocal && <ErrorMessage failure={other.failure} />}
      <Loaded result={result} lines={16}>
        {(lines) => <CentrelinePlots lines={lines} other={other.data} overlaid={overlaid} />}
      </Loaded>
    </Panel>
  );
}

function PathOverlaySelect({ machine, shown, overlaid }: { machine: string; shown: number; overlaid: string }) {
  const all = useResource<IdentificationSummary[]>(`/machines/${machine}/identifications?limit=${LIMIT}`).data ?? [];
  const others = all.filter((one) => one.accepted && one.id !== shown);
  return (
    <label>
      {t("overlay")}
      <select value={overlaid} onChange={(event) => replaceQuery({ overlay: event.currentTarget.value || null })}>
        <option value="">{t("none")}</option>
        {overlaid !== "" && !others.some((one) => String(one.id) === overlaid) && <option value={overlaid}>{overlaid}</option>}
        {others.map((one) => (
          <option key={one.id} value={one.id}>{`${one.id}  ${term(one.run_kind)}, ${when(one.measured_at)}`}</option>
        ))}
      </select>
    </label>
  );
}

function CentrelinePlots({ lines, other, overlaid }: { lines: Centreline; other: Centreline | undefined; overlaid: string }) {
  const units = useUnits();
  const names = [...namesOf(lines), ...(other ? namesOf(other, overlaid) : [])];
  const linesIn = (bearing: string) => [
    ...linesOf(lines, bearing, units, namesOf(lines), 0),
    ...(other ? linesOf(other, bearing, units, namesOf(other, overlaid), namesOf(lines).length) : []),
  ];
  return (
    <>
      <p class="muted">
        <CurveLegend curves={names.map((name, style) => ({ name, style }))} /> · {measuredText(lines)}
      </p>
      <div class="orbits shapes">
        {lines.bearings.map((one) => (
          <CentrelinePlot
            key={one.bearing}
            bearing={one.bearing}
            clearance={one.clearance_um * units.length.factor}
            unit={units.length.label}
            lines={linesIn(one.bearing)}
            speedUnit={units.speed.label}
          />
        ))}
      </div>
    </>
  );
}

/** Names of the model's line and of each run's gaps, with the number of an identification that is overlaid. */
function namesOf({ measured }: Centreline, overlaid = ""): string[] {
  const model = overlaid ? t("modelsLineOf", { id: overlaid }) : t("modelsLine");
  return [model, ...measured.map(({ run }) => t("gapsOfRun", { run }))];
}

function measuredText({ measured }: Centreline): string {
  if (measured.length === 0) return t("noGapsInTheseRuns");
  return t("zerosSetByTheModel");
}

/** style: style of the line of the first name. */
function linesOf(found: Centreline, bearing: string, { length, speed }: Units, names: string[], style: number): JournalLine[] {
  const modelled = found.bearings.find((one) => one.bearing === bearing);
  const line = (at: number, rpm: number[], x: (number | null)[], y: (number | null)[]): JournalLine => ({
    name: names[at]!, style: style + at, speed: speedsInUnit(rpm, speed), x: inUnit(x, length), y: inUnit(y, length), measured: at > 0,
  });
  const measured = found.measured.flatMap((run, at): JournalLine[] => {
    const own = run.bearings.find((one) => one.bearing === bearing);
    return own ? [line(at + 1, run.speed, own.x_um, own.y_um)] : [];
  });
  return [...(modelled ? [line(0, found.speed, modelled.x_um, modelled.y_um)] : []), ...measured];
}
