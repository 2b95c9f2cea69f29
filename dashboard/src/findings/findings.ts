// Everything that the page says of findings: their kinds, labels and causes, and the limits that each kind has.
import { LIMIT_NAMES, MENDED_BY_BALANCING, NAMED_AS_ELEMENTS, PRESENT, QUANTITIES, RULES, type LimitName, type RuleName } from "../declarations/findings";
import { elementId, elementKind, elementName, words } from "../format/names";
import { decimal } from "../format/numbers";
import { t } from "../messages/messages";

export const FINDING_KINDS = RULES;

export type FindingKind = RuleName;

/** A kind's label: `run out` of `run_out`. Also for kinds without limits, such as `misfit`. */
export function findingLabel(kind: string): string {
  return words(kind);
}

/** A hypothesis in words: `misalignment of coupling C1`. */
export function causeLabel({ kind, element }: { kind: string; element: string }): string {
  if (!elementId(element)) return findingLabel(kind);
  return isElementsOwn(kind, element) ? t("itself", { element: elementName(element) }) : t("of", { finding: findingLabel(kind), element: elementName(element) });
}

/** What a finding is about, as a heading: `Misalignment of coupling C1`, `Bearing B2`. */
export function findingTitle(kind: string, element: string): string {
  const words = !elementId(element) ? findingLabel(kind) : isElementsOwn(kind, element) ? elementName(element) : t("of", { finding: findingLabel(kind), element: elementName(element) });
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Whether an alert's cause is present and no weight mends it, as the service judges that refuses to propose masses. */
export function speaksAgainstBalancing({ rule, element, condition }: { rule: string; element: string; condition: string }): boolean {
  return PRESENT.includes(condition) && !MENDED_BY_BALANCING[rule]?.includes(elementKind(element));
}

/** Whether a finding is called as its element: that of a seal is called `bearing` as well. */
function isElementsOwn(kind: string, element: string): boolean {
  return NAMED_AS_ELEMENTS.includes(kind) || words(elementKind(element)) === findingLabel(kind);
}

export const LEVELS = ["alert", "danger"] as const;

export type { LimitName };

export interface LimitQuantity {
  name: LimitName;
  label: string;
  unit: string;
}

/** Labels and units of all quantities: one that the service declares newly is missed when the page is built. */
const LIMIT_WORDS: Record<LimitName, { label: string; unit: string }> = {
  sigma: { label: t("significance"), unit: "σ" },
  per_cent: { label: t("limitChange"), unit: "%" },
  force: { label: t("forceInTheCoupling"), unit: "N" },
  rate_per_cent_per_week: { label: t("limitRate"), unit: t("perWeek") },
  tolerance_per_cent: { label: t("changeOnOilFilms"), unit: t("ofWhatIsAllowed") },
  beyond_tolerance: { label: t("probabilityOfMoreThanIs"), unit: t("probability") },
};

const LIMIT_QUANTITIES: LimitQuantity[] = LIMIT_NAMES.map((name) => ({ name, ...LIMIT_WORDS[name] }));

/** The quantities that may be limited for a kind. */
export function limitQuantities(kind: FindingKind): LimitQuantity[] {
  return LIMIT_QUANTITIES.filter(({ name }) => QUANTITIES[kind].includes(name));
}

/** A level's limits in words: `4 σ, 5 %`; `never` without a level. */
export function levelText(level: Record<LimitName, number | null> | null): string {
  if (level === null) return t("never");
  return LIMIT_QUANTITIES.filter(({ name }) => level[name] !== null)
    .map(({ name, unit }) => `${decimal(String(level[name]))} ${unit}`)
    .join(", ");
}
