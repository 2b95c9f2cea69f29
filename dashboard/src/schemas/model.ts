// Predictions of an identified model: response, critical speeds, modes, coupling loads, balancing.
import type { Column } from "./columns";
import type { Sense } from "./machines";

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

/** Places of a journal's centre from its bearing's [µm]: x to the right, y up. */
export interface JournalPlaces {
  bearing: string;
  x_um: Column;
  y_um: Column;
}

export interface Centreline {
  speed: number[];
  bearings: (JournalPlaces & { clearance_um: number })[];
  measured: { run: number; speed: number[]; bearings: JournalPlaces[] }[];
}

/** Coefficients of oil films over speed in SI units; null where the data leave them too uncertain. */
export interface FilmCurves {
  speed: number[];
  bearings: { bearing: string; coefficients: { term: string; unit: string; value: Column; lower: Column; upper: Column }[] }[];
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

/** A number with its interval in SI units, or the reason why it is not determined. */
export interface Determined {
  value: number | null;
  lower: number | null;
  upper: number | null;
  reason: string | null;
}

export interface AlignmentNumber {
  name: string;
  coupling: string;
  quantity: string;
  unit: string;
  absolute: Determined;
  change: Determined | null;
  /** How large the change may be, in SI units. */
  allowed: number | null;
  /** Probability that the change is larger. */
  beyond: number | null;
  target: AlignmentTarget | null;
}

/** What the document aims at in the state that such a run shows, and by how much the alignment is larger, in SI units. */
export interface AlignmentTarget {
  state: "cold" | "hot";
  target: number;
  off: Determined;
  allowed: number;
  beyond: number | null;
}

/** Load on a bearing's oil film against the baseline, in newtons. */
export interface LoadNumber {
  name: string;
  bearing: string;
  quantity: string;
  unit: string;
  before: number;
  change: Determined;
  change_per_cent: number | null;
}

export interface Alignment {
  missing: string | null;
  baseline: { identifications: number[] };
  numbers: AlignmentNumber[];
  /** Changes of loads that belong to those of the alignment; none without a baseline. */
  loads: LoadNumber[];
}
