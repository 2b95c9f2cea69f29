// The coefficients of an oil film: stiffness and damping as curves over speed with bands, and their numbers at the speeds that
// an identification tells them at.
import { speedsInUnit, useUnits } from "../browser/units";
import { Scroll } from "../components/scroll";
import { Speed, useSpeedText } from "../components/speed";
import { TERMS } from "../declarations/terms";
import { number, scaled, scaleOf, type Scale } from "../format/numbers";
import { t } from "../messages/messages";
import { Plot } from "../plots/plot";
import type { Column } from "../schemas/columns";
import type { FilmCurves } from "../schemas/model";
import { missingReasons, type Bounded, type FilmCoefficient, type OilFilm } from "../words/oil-films";

const KINDS = [
  ["stiffness", t("stiffness")],
  ["damping", t("damping")],
] as const;

export function FilmCoefficients({ film, curves }: { film: OilFilm; curves: FilmCurves }) {
  const speedText = useSpeedText();
  const named = film.coefficients.flatMap(({ term, at }) => at.map((one, place): [string, Bounded | undefined] => [t("termAtSpeed", { term, speed: speedText(film.speeds[place]) }), one]));
  return (
    <>
      <div class="film-plots">
        {KINDS.map(([quantity, kind]) => (
          <Kind key={quantity} quantity={quantity} kind={kind} film={film} curves={curves} />
        ))}
      </div>
      {missingReasons(named).map(([reason, names]) => (
        <p key={reason} class="muted">
          {names.join(", ")}: {reason}
        </p>
      ))}
    </>
  );
}

interface KindProps {
  quantity: (typeof KINDS)[number][0];
  kind: string;
  film: OilFilm;
  curves: FilmCurves;
}

function Kind({ quantity, kind, film, curves }: KindProps) {
  const { speed } = useUnits();
  const speedText = useSpeedText();
  const ofKind = ({ term }: { term: string }) => TERMS[term]?.quantity === quantity;
  const coefficients = film.coefficients.filter(ofKind);
  const own = curves.bearings.find((one) => one.bearing === film.bearing)?.coefficients.filter(ofKind) ?? [];
  const scale = scaleOf(Math.max(0, ...own.flatMap((one) => one.value.map((at) => Math.abs(at ?? 0)))), own[0]?.unit ?? "");
  const numbers = (one: FilmCoefficient) => one.at.map((at) => number(scaled(at?.value, scale)));
  const column = (values: Column) => values.map((one) => scaled(one, scale));
  return (
    <figure>
      <figcaption>
        <strong>{film.bearing}</strong> {kind} [{scale.unit}]
      </figcaption>
      <Plot
        label={t("filmCoefficientPlot", { kind, bearing: film.bearing, unit: scale.unit, speeds: film.speeds.map(speedText).join(", "), values: coefficients.map((one) => `${one.term} ${numbers(one).join(", ")}`).join("; ") })}
        x={speedsInUnit(curves.speed, speed)}
        xUnit={speed.label}
        yUnit={scale.unit}
        height={220}
        syncGroup="films"
        curves={own.map((one) => ({ name: one.term, y: column(one.value), lower: column(one.lower), upper: column(one.upper) }))}
      />
      <CoefficientTable speeds={film.speeds} coefficients={coefficients} scale={scale} />
    </figure>
  );
}

function CoefficientTable({ speeds, coefficients, scale }: { speeds: number[]; coefficients: FilmCoefficient[]; scale: Scale }) {
  return (
    <Scroll label={t("table")}>
      <table>
        <thead>
          <tr>
            <th>{scale.unit}</th>
            {speeds.map((one) => (
              <th key={one} class="number" scope="col">
                <Speed rpm={one} />
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {coefficients.map((one) => (
            <tr key={one.term}>
              <th scope="row">{one.term}</th>
              {one.at.map((at, place) => (
                <CoefficientCell key={speeds[place]} one={at} scale={scale} />
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </Scroll>
  );
}

function CoefficientCell({ one, scale }: { one: Bounded | undefined; scale: Scale }) {
  if (!one || one.value === null) return <td class="number muted">{t("notEstimable")}</td>;
  return (
    <td class="number">
      {number(scaled(one.value, scale))} <small class="muted">{`${number(scaled(one.lower, scale))} … ${number(scaled(one.upper, scale))}`}</small>
    </td>
  );
}
