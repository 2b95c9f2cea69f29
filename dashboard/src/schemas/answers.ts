// What the service answers, as far as the page reads it. The API's document (/api/v1/docs) says what each field means.
import type { RuleName } from "../words/findings";

export interface MachineSummary {
  id: string;
  plant: string;
  name: string;
  revision: number;
}

/** Positive turns +x towards +y. */
export type Sense = "positive" | "negative";

export interface Document {
  id: string;
  plant: string;
  name: string;
  rotation?: Sense;
  speed_range: { minimum_rpm: number; maximum_rpm: number };
  couplings: { id: string }[];
  bearings: { id: string }[];
  discs: { id: string }[];
  probes: { id: string }[];
}

export interface MachineRevision {
  id: string;
  revision: number;
  created_at: string;
  document: Document;
}

export interface OpenRun {
  id: number;
  kind: string;
  started_at: string;
  progress: number;
}

export interface MachineState {
  machine: string;
  state: string;
  since: string | null;
  speed_rpm: number | null;
  direction: "positive" | "negative" | null;
  newest_sample_at: string | null;
  run: OpenRun | null;
}

export interface Run {
  id: number;
  machine: string;
  kind: string;
  state: string;
  reason: string | null;
  started_at: string;
  ended_at: string | null;
  samples: number | null;
  speed_minimum_rpm: number | null;
  speed_maximum_rpm: number | null;
  coverage: { part: number } | null;
  quality: { points: number; usable: number; findings: string[] } | null;
}

export interface Job {
  id: number;
  scope: string;
  runs: number[];
  state: string;
  attempts: number;
  error: string | null;
  created_at: string;
}

export interface Phasors {
  channels: string[];
  time: string[];
  speed_rpm: number[];
  amplitude_um_pp: (number | null)[][];
  phase_lag_deg: (number | null)[][];
  /** Vectors that were subtracted; null: raw. */
  slow_roll_version: number | null;
  slow_roll_left_out: Record<string, string>;
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

export interface Alert {
  id: number;
  machine: string;
  rule: string;
  element: string;
  state: string;
  condition: string;
  severity: string;
  latching: boolean;
  suppressions: string[];
  message: string;
  evidence: Partial<Evidence>;
  identification: number;
  measured_at: string;
  first_measured_at: string;
  opened_at: string;
  updated_at: string;
  closed_at: string | null;
  events: number;
}

/** What an alert of a diagnosis rests on; alerts of other rules hold other things. */
export interface Evidence {
  kind: string;
  sigma: number;
  since: string;
  runs: number;
  form: string | null;
  misalignment_force: number | null;
  moved: { parameter: string; change: number; sigma: number }[];
  runners_up: { kind: string; element: string; evidence: number }[];
}

export interface AlertEvent {
  id: number;
  alert: number;
  number: number;
  machine: string;
  element: string;
  at: string;
  kind: string;
  state_before: string;
  state: string;
  severity: string;
  message: string;
  by: string;
  comment: string;
}

export interface TimelineEntry {
  id: number;
  at: string;
  kind: string;
  text: string;
  by: string;
}

export interface AxisPhasor {
  real_um: number;
  imaginary_um: number;
}

export interface Orbit {
  shaft: string;
  station: number;
  channels: string[];
  speed_rpm: number;
  x: AxisPhasor;
  y: AxisPhasor;
  semi_major_um: number;
  semi_major_error_um: number;
  semi_minor_um: number;
  semi_minor_error_um: number;
  sense: string;
}

export interface Orbits {
  slow_roll_version: number | null;
  slow_roll_left_out: Record<string, string>;
  orbits: Orbit[];
  without: string[][];
  findings: { code: string; channels: string[]; words: string }[];
}

export interface Series {
  parameter: string;
  unit: string;
  down_sampling?: { method: string; points: number };
  measured_at: string[];
  value: (number | null)[];
  lower: (number | null)[];
  upper: (number | null)[];
  /** Of a vector such as an unbalance. */
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

type Column = (number | null)[];

export interface Bode {
  fitted: { speed: number[]; channels: { channel: string; amplitude: Column; phase: Column; lower: Column; upper: Column }[] };
  measured: MeasuredRun[];
}

export interface MeasuredRun {
  run: number;
  speed: number[];
  channels: { channel: string; amplitude: Column; phase: Column; used: boolean[]; residual: Column; residual_sigma: Column }[];
}

export interface CriticalSpeed {
  speed: number;
  standard_error: number | null;
  lower: number | null;
  upper: number | null;
  damping_ratio: number;
  log_decrement: number;
  whirl: number;
}

export interface CriticalSpeeds {
  highest: number;
  critical_speeds: CriticalSpeed[];
}

export interface Campbell {
  speed: number[];
  synchronous_hz: Column;
  curves: { frequency_hz: Column; damping_ratio: Column; whirl: Column }[];
  critical_speeds: CriticalSpeed[];
}

export interface Displacement {
  real: number[];
  imaginary: number[];
}

export interface ModeShape {
  frequency_hz: number;
  standard_error_hz: number | null;
  damping_ratio: number;
  log_decrement: number;
  whirl: number;
  shafts: { shaft: string; at: number[]; x: Displacement; y: Displacement; semi_major: number[]; semi_minor: number[] }[];
}

export interface Modes {
  speed: number;
  modes: ModeShape[];
}

export interface Load {
  amplitude: Column;
  lower: Column;
  upper: Column;
  phase: Column;
}

export interface MisalignmentForce {
  speed: number[];
  couplings: { coupling: string; force_x: Load; force_y: Load; moment_x: Load; moment_y: Load }[];
}

export interface Balancing {
  direction: Sense;
  speed: number[];
  corrections: { plane: string; unbalance_g_mm: number; angle_deg: number }[];
  before: { channel: string; amplitude: Column; lower: Column; upper: Column }[];
  after: { channel: string; amplitude: Column; lower: Column; upper: Column }[];
  condition_number: number;
}

export interface Drawing {
  length: number;
  sections: { shaft: string; begin: number; end: number; outer_diameter: number; inner_diameter: number }[];
  discs: { element: string; at: number; radius: number | null; width: number | null }[];
  bearings: { element: string; at: number }[];
  seals: { element: string; at: number }[];
  couplings: { element: string; at: number }[];
  probes: { channel: string; at: number; angle_deg: number }[];
}

export interface FleetMachine {
  id: string;
  plant: string;
  name: string;
  state: string;
  state_since: string | null;
  speed_rpm: number | null;
  newest_sample_at: string | null;
  open_run: OpenRun | null;
  last_run: { id: number; kind: string; state: string; started_at: string } | null;
  last_identification: { id: number; measured_at: string; accepted: boolean; verdict: string } | null;
  open_alerts: Record<string, number>;
  unacknowledged: number;
  happened: Record<"runs" | "identifications" | "alert_events" | "revisions" | "timeline", number>;
}

export interface Fleet {
  since: string;
  machines: FleetMachine[];
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

export interface Deviations {
  identification: number;
  measured_at: string;
  run_kind: string;
  baseline: { identifications: number[]; wanted: number; since: string | null; reason: string | null; by: string | null };
  missing: string | null;
  left_out: Record<string, string>;
  parameters: ParameterDeviation[];
  elements: { element: string; distance: number; degrees_of_freedom: number; probability: number }[];
}

export interface TrendTest {
  name: string;
  runs: number;
  newest: number;
  step_up: Chart;
  step_down: Chart | null;
  creep: Chart;
  drift: Drift | null;
}

export interface Chart {
  value: number;
  limit: number;
  passed: boolean;
  began: string | null;
}

export interface Drift {
  per_week: number;
  lower: number;
  upper: number;
  probability: number;
  alert: Ahead | null;
  danger: Ahead | null;
}

export interface Ahead {
  per_cent: number;
  expected: number | null;
  earliest: number | null;
  latest: number | null;
}

export interface TrendTests {
  missing: string | null;
  tests: TrendTest[];
}

export interface Suppression {
  id: number;
  machine: string;
  kind: string;
  rule: string | null;
  element: string | null;
  since: string;
  until: string | null;
  by: string;
  comment: string;
}

export interface Subscription {
  id: number;
  kind: string;
  name: string;
  target: string;
  state: string;
  reason: string | null;
  created_at: string;
}

/** secret: of a webhook, shown once. */
export interface NewSubscription extends Subscription {
  secret: string | null;
}

export interface Delivery {
  id: number;
  event: number;
  alert: number;
  state: string;
  attempts: number;
  last_try_at: string | null;
  answer: string | null;
}

export interface TestOutcome {
  result: string;
  answer: string;
}

/** From where on something is an alert, or a danger; null does not matter. */
export interface Level {
  sigma: number | null;
  per_cent: number | null;
  force: number | null;
  rate_per_cent_per_week: number | null;
}

export interface Rule {
  alert: Level;
  danger: Level | null;
  on_delay: number;
  off_delay: number;
  hysteresis: number;
  latching: boolean;
}

export type Limits = Record<RuleName, Rule> & { elements: Record<string, Partial<Record<RuleName, Rule>>> };

export interface LimitsVersion {
  version: number;
  limits: Limits;
  set_at: string | null;
  by: string | null;
  comment: string | null;
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
