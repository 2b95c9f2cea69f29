// Kinds of findings that have limits of their own.

export const RULES = ["misalignment", "bearing", "coupling", "unbalance", "run_out", "sensor", "rate_of_change"] as const;

export type RuleName = (typeof RULES)[number];
