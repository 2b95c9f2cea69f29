// The oil films of an identified machine: where the journals rest in their clearances, what they carry, and the coefficients
// of a chosen bearing or, on paper, of all.
import type { DataColumn } from "../browser/download";
import { replaceQuery, route } from "../browser/router";
import { useStore } from "../browser/store";
import { useUnits } from "../browser/units";
import { Loaded } from "../components/loading";
import { Panel } from "../components/panel";
import { Speed } from "../components/speed";
import { useResource } from "../data/resource";
import { number, scaleOf, type ShownUnits } from "../format/numbers";
import { rich, t } from "../messages/messages";
import { ClearanceCircle, type Coordinate } from "../plots/clearance-circle";
import { SaveDrawing } from "../plots/save-buttons";
import type { Identification } from "../schemas/identifications";
import type { Document } from "../schemas/machines";
import type { FilmCurves } from "../schemas/model";
import { missingReasons, oilFilms, type Bounded, type OilFilm } from "../words/oil-films";
import { FilmCoefficients } from "./film-coefficients";

type DocumentFilm = NonNullable<Document["bearings"][number]["film"]>;

interface Props {
  machine: Document;
  found: Identification;
  /** Show the coefficients of all bearings: paper has no choice. */
  showsAll?: boolean;
}

/** Nothing where the identification tells of no films. */
export function OilFilmsPanel({ machine, found, showsAll = false }: Props) {
  const films = oilFilms(found, machine);
  const curves = useResource<FilmCurves>(films.length > 0 ? `/identifications/${found.id}/model/film-coefficients` : null);
  if (films.length === 0) return null;
  const documented = (bearing: string) => machine.bearings.find((one) => one.id === bearing)?.film ?? undefined;
  const withCoefficients = films.filter((one) => one.coefficients.length > 0);
  const isPreloaded = films.some((one) => (documented(one.bearing)?.preload ?? 0) > 0);
  return (
    <Panel title={t("oilFilms")} aside={<p class="muted">{rich("atWithIntervals", { speed: <Speed rpm={films[0]!.speeds.at(-1)} /> })}</p>}>
      <p class="muted">
        {t("journalInClearance", { preload: isPreloaded && t("dashedWhatThePreloadOf"), sense: turning(machine) })}
      </p>
      <div class="films shapes">
        {films.map((one) => (
          <FilmFigure key={one.bearing} film={one} documented={documented(one.bearing)} />
        ))}
      </div>
      {withCoefficients.length > 0 && <h3>{t("coefficientsOverSpeed")}</h3>}
      {withCoefficients.length > 0 && (
        <Loaded result={curves} lines={12}>
          {(found) =>
            showsAll ? withCoefficients.map((one) => <FilmCoefficients key={one.bearing} film={one} curves={found} />) : <ChosenCoefficients films={withCoefficients} curves={found} />
          }
        </Loaded>
      )}
    </Panel>
  );
}

function turning({ rotation }: Document): string {
  return rotation ? t("shaftTurns", { sense: rotation === "positive" ? t("counterClockwise") : t("clockwise") }) : "";
}

function ChosenCoefficients({ films, curves }: { films: OilFilm[]; curves: FilmCurves }) {
  const { query } = useStore(route);
  const chosen = films.find((one) => one.bearing === query.get("bearing")) ?? films[0];
  if (!chosen) return null;
  return (
    <>
      <div class="choices">
        <BearingSelect films={films} chosen={chosen.bearing} />
      </div>
      <FilmCoefficients film={chosen} curves={curves} />
    </>
  );
}

function BearingSelect({ films, chosen }: { films: OilFilm[]; chosen: string }) {
  return (
    <label>
      {t("bearing")}
      <select value={chosen} onChange={(event) => replaceQuery({ bearing: event.currentTarget.value })}>
        {films.map((one) => (
          <option key={one.bearing} value={one.bearing}>
            {one.bearing}
          </option>
        ))}
      </select>
    </label>
  );
}

function FilmFigure({ film, documented }: { film: OilFilm; documented: DocumentFilm | undefined }) {
  const preload = documented?.preload ?? 0;
  const units = useUnits();
  const hasPads = documented?.profile !== undefined && !["plain", "two_axial_grooves"].includes(documented.profile);
  const numbers: [string, Bounded | undefined][] = [
    [hasPads ? t("clearanceOfThePads") : t("radialClearance"), film.clearance],
    [t("journalX"), film.journalX],
    [t("journalY"), film.journalY],
    [t("eccentricityRatio"), film.eccentricity],
    [t("loadVertical"), film.loadVertical],
    [t("loadHorizontal"), film.loadHorizontal],
    [t("viscosity"), film.viscosity],
    [t("viscosityFactorOfOil", { name: film.supply?.name }), film.supply?.factor],
  ];
  const rows = numbers.flatMap(([name, one]): [string, Bounded][] => (one ? [[name, one]] : []));
  return (
    <figure>
      <figcaption>
        <strong>{film.bearing}</strong>
        {film.radius !== null && <SaveDrawing label={t("oilFilmLabel", { bearing: film.bearing })} columns={() => columnsOf(rows)} />}
      </figcaption>
      <div class="film">
        {film.radius !== null && (
          <ClearanceCircle
            label={t("oilFilmDrawing", { bearing: film.bearing, values: rows.map(([name, one]) => `${name.toLowerCase()} ${boundsText(one, units)}`).join("; ") })}
            radius={film.radius}
            assembled={preload > 0 ? film.radius * (1 - preload) : undefined}
            position={positionOf(film)}
          />
        )}
        <table>
          <tbody>
            {rows.map(([name, one]) => (
              <FilmRow key={name} name={name} one={one} units={units} />
            ))}
          </tbody>
        </table>
      </div>
      {missingReasons(rows).map(([reason, names]) => (
        <p key={reason} class="muted">
          {names.join(", ")}: {reason}
        </p>
      ))}
    </figure>
  );
}

function columnsOf(rows: [string, Bounded][]): DataColumn[] {
  return [
    { name: t("csvQuantity"), values: rows.map(([name]) => name) },
    { name: t("csvValue"), values: rows.map(([, one]) => one.value) },
    { name: t("csvLower"), values: rows.map(([, one]) => one.lower) },
    { name: t("csvUpper"), values: rows.map(([, one]) => one.upper) },
    { name: t("csvUnit"), values: rows.map(([, one]) => one.unit) },
  ];
}

function positionOf({ journalX, journalY }: OilFilm): { x: Coordinate; y: Coordinate } | null {
  const coordinate = (one: Bounded | undefined): Coordinate | null => (one && one.value !== null ? { ...one, value: one.value } : null);
  const [x, y] = [coordinate(journalX), coordinate(journalY)];
  return x && y && { x, y };
}

function FilmRow({ name, one, units }: { name: string; one: Bounded; units: ShownUnits }) {
  const text = textOf(one, units);
  return (
    <tr>
      <th scope="row">{name}</th>
      {text === null ? (
        <td class="number muted">{t("notEstimable")}</td>
      ) : (
        <td class="number">
          {text.value} <small class="muted">{`${text.lower} … ${text.upper}`}</small>
        </td>
      )}
    </tr>
  );
}

/** A number with its unit and its bounds in the same; null where it is not known. One near zero has the unit of its interval. */
function textOf({ value, lower, upper, unit }: Bounded, units: ShownUnits): { value: string; lower: string; upper: string } | null {
  if (value === null) return null;
  const scale = scaleOf(Math.max(...[value, lower, upper].map((one) => Math.abs(one ?? 0))), unit, units);
  const shown = (one: number | null) => number(one === null ? null : one * scale.factor);
  return { value: `${shown(value)} ${scale.unit}`.trim(), lower: shown(lower), upper: shown(upper) };
}

function boundsText(one: Bounded, units: ShownUnits): string {
  const text = textOf(one, units);
  return text ? t("valueWithBounds", { value: text.value, lower: text.lower, upper: text.upper }) : t("notEstimable");
}
