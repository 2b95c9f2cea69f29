// Written by `python -m service.commands.page_declarations` from service/monitoring/finding_rules.py; not to be changed here.

/** Kinds of findings that have limits of their own. */
export const RULES = ["misalignment", "bearing", "coupling", "pedestal", "settlement", "wear", "oil", "process_force", "unbalance", "rotating_coupling", "run_out", "sensor", "rate_of_change"] as const;

export type RuleName = (typeof RULES)[number];

/** Quantities that the limits of each kind may name. */
export const QUANTITIES: Record<RuleName, readonly string[]> = {
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
