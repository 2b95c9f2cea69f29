// Identifications: jobs, estimates, derived quantities, comparison and correlation.

export interface Job {
  id: number;
  scope: string;
  runs: number[];
  state: string;
  attempts: number;
  error: string | null;
  created_at: string;
}

export interface Estimate {
  parameter: string;
  element: string;
  quantity: string;
  unit: string;
  value: number | null;
  standard_error: number | null;
  lower: number | null;
  upper: number | null;
  imaginary: number | null;
  imaginary_standard_error: number | null;
  magnitude: number | null;
  angle_deg: number | null;
  angle_half_width_deg: number | null;
  reason: string | null;
}

export interface IdentificationSummary {
  id: number;
  machine: string;
  scope: string;
  run_kind: string;
  runs: number[];
  measured_at: string;
  computed_at: string;
  accepted: boolean;
  verdict: string;
  chi_square: number;
  degrees_of_freedom: number;
  condition_number: number;
  samples: number;
  speed_minimum_rpm: number;
  speed_maximum_rpm: number;
  code_version: string;
  slow_roll_version: number | null;
}

/** A quantity that follows from an identification. */
export interface Derived {
  name: string;
  unit: string;
  value: number | null;
  lower: number | null;
  upper: number | null;
  reason: string | null;
}

export interface Identification extends IdentificationSummary {
  estimates: Estimate[];
  derived: Derived[];
}

export interface ComparedChange {
  parameter: string;
  first: number | null;
  second: number | null;
  per_cent: number | null;
  sigma: number | null;
}

export interface Comparison {
  first: number;
  second: number;
  changes: ComparedChange[];
  elements: { element: string; probability: number }[];
  only_first: string[];
  only_second: string[];
}

export interface Correlation {
  coordinates: string[];
  correlation: number[][];
  strongest: { one: string; other: string; correlation: number }[];
}
