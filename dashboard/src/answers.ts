// What the service answers, as far as the page reads it. The API's document (/api/v1/docs) says what each field means.

export interface MachineSummary {
  id: string;
  plant: string;
  name: string;
  revision: number;
}

export interface Section {
  length: number;
  outer_diameter: number;
  inner_diameter: number;
}

export interface Placed {
  id: string;
  shaft: string;
  station: number;
}

export interface Disc extends Placed {
  mass: number;
  polar_inertia: number;
}

export interface Probe extends Placed {
  angle_deg: number;
}

export interface Coupling {
  id: string;
  driver: string;
  driven: string;
}

export interface Document {
  id: string;
  plant: string;
  name: string;
  rotation: "positive" | "negative";
  speed_range: { minimum_rpm: number; maximum_rpm: number };
  shafts: { id: string; sections: Section[] }[];
  discs: Disc[];
  bearings: Placed[];
  seals: Placed[];
  couplings: Coupling[];
  probes: Probe[];
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
  reason: string | null;
}

export interface IdentificationSummary {
  id: number;
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
}

export interface Identification extends IdentificationSummary {
  estimates: Estimate[];
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
  identification: number;
  measured_at: string;
  opened_at: string;
  updated_at: string;
  closed_at: string | null;
  events: number;
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
  orbits: Orbit[];
  without: string[][];
  findings: { code: string; channels: string[]; words: string }[];
}
