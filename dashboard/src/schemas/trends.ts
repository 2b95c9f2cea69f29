// Histories of parameters, their baselines, deviations and trend tests.

export interface Series {
  parameter: string;
  unit: string;
  down_sampling?: { method: string; points: number };
  measured_at: string[];
  value: (number | null)[];
  lower: (number | null)[];
  upper: (number | null)[];
  /** Parts of a vector such as an unbalance. */
  real?: (number | null)[] | null;
  imaginary?: (number | null)[] | null;
  angle_deg?: (number | null)[] | null;
  angle_half_width_deg?: (number | null)[] | null;
  quality: string[];
  run_kind: string[];
  identification: number[];
  baselines: BaselineBand[];
}

/** Where 95 % of the estimates lie while nothing happens. */
export interface BaselineBand {
  run_kind: string;
  since: string;
  until: string | null;
  centre: number;
  lower: number;
  upper: number;
}

export interface Trends {
  machine: string;
  scope: string;
  series: Series[];
}

export interface ParameterDeviation {
  parameter: string;
  element: string;
  per_cent: number;
  lower_per_cent: number;
  upper_per_cent: number;
  sigma: number;
  probability: number;
  added: number | null;
  added_angle_deg: number | null;
  reaches: string | null;
}

/** A figure of what an element has changed by as a whole, the mean of so many runs. */
export interface ElementSize {
  name: string;
  unit: string;
  value: number;
  lower: number;
  upper: number;
  runs: number | null;
  /** Value in the baseline; null where only the change is given. */
  before: number | null;
}

export interface Deviations {
  identification: number;
  measured_at: string;
  run_kind: string;
  baseline: { identifications: number[]; wanted: number; since: string | null; reason: string | null; by: string | null };
  missing: string | null;
  left_out: Record<string, string>;
  parameters: ParameterDeviation[];
  elements: { element: string; distance: number; degrees_of_freedom: number; probability: number; together: ElementSize[] }[];
}

export interface TrendTest {
  name: string;
  runs: number;
  newest: number;
  step_up: ControlChart;
  step_down: ControlChart | null;
  creep: ControlChart;
  drift: Drift | null;
}

export interface ControlChart {
  value: number;
  limit: number;
  passed: boolean;
  began: string | null;
  /** Number of runs since the step began; null without a step. */
  runs?: number | null;
}

export interface Drift {
  per_week: number;
  lower: number;
  upper: number;
  probability: number;
  alert: LimitForecast | null;
  danger: LimitForecast | null;
}

export interface LimitForecast {
  per_cent: number;
  expected: number | null;
  earliest: number | null;
  latest: number | null;
}

export interface TrendTests {
  missing: string | null;
  tests: TrendTest[];
}
