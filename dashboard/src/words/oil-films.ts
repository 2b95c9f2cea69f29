// The oil films that an identification tells of: states of journals and oil at running speed, coefficients at some speeds.
import { termName } from "../format/names";
import { stored } from "../messages/messages";
import type { Derived, Estimate, Identification } from "../schemas/identifications";
import type { Document } from "../schemas/machines";

/** A number with its interval, or the reason why it has none. */
export type Bounded = Pick<Derived, "unit" | "value" | "lower" | "upper" | "reason">;

export interface FilmCoefficient {
  /** `kxx` */
  term: string;
  /** Coefficient at each of the film's speeds. */
  at: (Bounded | undefined)[];
}

export interface OilFilm {
  bearing: string;
  /** The radial clearance, where it is estimated. */
  clearance: Bounded | undefined;
  /** The radial clearance that the model has, also where the data say nothing of it [m]; null where it is not known. */
  radius: number | null;
  journalX: Bounded | undefined;
  journalY: Bounded | undefined;
  eccentricity: Bounded | undefined;
  loadVertical: Bounded | undefined;
  loadHorizontal: Bounded | undefined;
  /** Viscosity of its own oil, where that is estimated. */
  viscosity: Bounded | undefined;
  /** How far the viscosity of the supply that its oil comes from is off, where that is estimated. */
  supply: { name: string; factor: Bounded } | undefined;
  /** Ascending; the last is running speed [r/min]. */
  speeds: number[];
  coefficients: FilmCoefficient[];
}

const JOURNAL = /^bearing\.([^.]+)\.journal_x$/;
const COEFFICIENT = /^([kc][xy][xy])@(\d+)rpm$/;

/** The films in the order of the bearings; none where the coefficients do not follow from films. */
export function oilFilms({ derived, estimates }: Pick<Identification, "derived" | "estimates">, machine: Document): OilFilm[] {
  return derived.flatMap(({ name }) => {
    const bearing = JOURNAL.exec(name)?.[1];
    const supply = machine.bearings.find((one) => one.id === bearing)?.film?.oil.supply;
    return bearing ? [filmOf(bearing, supply ?? undefined, derived, estimates)] : [];
  });
}

function filmOf(bearing: string, supply: string | undefined, derived: Derived[], estimates: Estimate[]): OilFilm {
  const element = `bearing.${bearing}.`;
  const own = new Map(derived.filter((one) => one.name.startsWith(element)).map((one) => [termName(one.name), one]));
  const estimate = (parameter: string) => estimates.find((one) => one.parameter === parameter);
  const clearance = estimate(`${element}clearance`);
  const factor = supply === undefined ? undefined : estimate(`oil.${supply}.viscosity_factor`);
  const [journalX, journalY, eccentricity] = [own.get("journal_x"), own.get("journal_y"), own.get("eccentricity_ratio")];
  return {
    bearing,
    clearance,
    radius: clearance?.value ?? radiusOf(journalX, journalY, eccentricity),
    journalX,
    journalY,
    eccentricity,
    loadVertical: own.get("load_vertical"),
    loadHorizontal: own.get("load_horizontal"),
    viscosity: estimate(`${element}viscosity`),
    supply: supply !== undefined && factor ? { name: supply, factor } : undefined,
    ...coefficientsOf(own),
  };
}

/** The eccentricity ratio is the journal's distance from the centre over the radial clearance. */
function radiusOf(x: Bounded | undefined, y: Bounded | undefined, eccentricity: Bounded | undefined): number | null {
  if (typeof x?.value !== "number" || typeof y?.value !== "number" || !eccentricity?.value) return null;
  return Math.hypot(x.value, y.value) / eccentricity.value;
}

function coefficientsOf(own: Map<string, Derived>): Pick<OilFilm, "speeds" | "coefficients"> {
  const found = [...own.keys()].flatMap((name) => {
    const [, term, rpm] = COEFFICIENT.exec(name) ?? [];
    return term && rpm ? [{ term, rpm: Number(rpm) }] : [];
  });
  const speeds = [...new Set(found.map((one) => one.rpm))].sort((a, b) => a - b);
  const terms = [...new Set(found.map((one) => one.term))];
  return { speeds, coefficients: terms.map((term) => ({ term, at: speeds.map((rpm) => own.get(`${term}@${rpm}rpm`)) })) };
}

/** Reasons why numbers are missing, each once with what it concerns. */
export function missingReasons(named: [string, Bounded | undefined][]): [string, string[]][] {
  const names = new Map<string, string[]>();
  for (const [name, one] of named) {
    const reason = one?.value === null && one.reason ? stored(one.reason) : "";
    if (reason) names.set(reason, [...(names.get(reason) ?? []), name]);
  }
  return [...names];
}
