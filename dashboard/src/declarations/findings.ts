// Written by `python -m service.commands.page_declarations` from service/monitoring/rules/finding_rules.py; not to be changed here.

/** Kinds of findings that have limits of their own. */
export const RULES = ["misalignment", "bearing", "coupling", "pedestal", "settlement", "wear", "oil", "process_force", "unbalance", "rotating_coupling", "run_out", "sensor", "rate_of_change"] as const;

export type RuleName = (typeof RULES)[number];

/** Kinds of findings that alerts are of, with and without limits. */
export const ALERT_RULES: readonly string[] = ["misalignment", "bearing", "coupling", "pedestal", "settlement", "wear", "oil", "process_force", "light_load", "heavy_load", "low_stability", "unbalance", "rotating_coupling", "run_out", "sensor", "misfit", "outliers", "rate_of_change"];

/** Quantities that a limit may name. */
export const LIMIT_NAMES = ["sigma", "per_cent", "force", "rate_per_cent_per_week", "tolerance_per_cent", "beyond_tolerance"] as const;

export type LimitName = (typeof LIMIT_NAMES)[number];

/** Quantities that the limits of each kind may name. */
export const QUANTITIES: Record<RuleName, readonly LimitName[]> = {
  misalignment: ["sigma", "per_cent", "force", "tolerance_per_cent", "beyond_tolerance"],
  bearing: ["sigma", "per_cent", "tolerance_per_cent"],
  coupling: ["sigma", "per_cent"],
  pedestal: ["sigma", "per_cent"],
  settlement: ["sigma", "tolerance_per_cent"],
  wear: ["sigma", "per_cent"],
  oil: ["sigma", "per_cent"],
  process_force: ["sigma", "per_cent"],
  unbalance: ["sigma", "per_cent"],
  rotating_coupling: ["sigma", "tolerance_per_cent"],
  run_out: ["sigma", "per_cent"],
  sensor: ["sigma", "per_cent"],
  rate_of_change: ["rate_per_cent_per_week"],
};

/** Kinds of findings that are called as elements are, and so are the element's own. */
export const NAMED_AS_ELEMENTS: readonly string[] = ["bearing", "coupling", "pedestal"];

/** Kinds of elements at which balancing mends what an alert reports, by the alert's rule. */
export const MENDED_BY_BALANCING: Readonly<Record<string, readonly string[]>> = {
  unbalance: ["disc"],
  rate_of_change: ["disc"],
};

/** Conditions of an alert whose cause is present. */
export const PRESENT: readonly string[] = ["acknowledged", "unacknowledged"];

/** Names of all kinds of findings, by language. */
export const FINDING_NAMES = {
  en: {"misalignment": "misalignment", "bearing": "bearing", "coupling": "coupling", "pedestal": "pedestal", "settlement": "settlement", "wear": "wear", "oil": "oil viscosity", "process_force": "static force", "light_load": "light load", "heavy_load": "heavy load", "low_stability": "low stability", "unbalance": "unbalance", "rotating_coupling": "rim and face run-out", "bow": "bow", "run_out": "run-out", "sensor": "measuring chain", "misfit": "model does not fit", "outliers": "outliers", "rate_of_change": "rate of change"},
  de: {"misalignment": "Ausrichtfehler", "bearing": "Lager", "coupling": "Kupplung", "pedestal": "Lagerbock", "settlement": "Setzung", "wear": "Verschleiß", "oil": "Ölviskosität", "process_force": "Prozesskraft", "light_load": "zu geringe Lagerlast", "heavy_load": "zu hohe Lagerlast", "low_stability": "geringe Stabilität", "unbalance": "Unwucht", "rotating_coupling": "Rund- und Planlauf", "bow": "Wellenkrümmung", "run_out": "Runout", "sensor": "Messkette", "misfit": "Modell passt nicht", "outliers": "Ausreißer", "rate_of_change": "Änderungsrate"},
};
