// Vibration at the probes: newest values, and the trend at running speed.
import type { Column } from "./columns";

/** Severity zone of an overall level. */
export type Zone = "A" | "B" | "C" | "D";

/** Boundaries of severity zones of overall levels, peak-to-peak [µm], and where the document has them from. */
export interface SeverityZones {
  source: string;
  a_b_um_pp: number;
  b_c_um_pp: number;
  c_d_um_pp: number;
}

/** Limits of the 1×, peak-to-peak [µm]; null where the document gives none. */
export interface VibrationLimits {
  balanced_um_pp: number | null;
  alert_um_pp: number | null;
  danger_um_pp: number | null;
  severity_zones: SeverityZones | null;
}

export interface VibrationVector {
  amplitude_um_pp: number;
  phase_lag_deg: number;
}

export interface ProbeVibration {
  channel: string;
  time: string | null;
  speed_rpm: number | null;
  first: VibrationVector | null;
  second: VibrationVector | null;
  overall_um_pp: number | null;
  zone: Zone | null;
  /** Place of the shaft towards the probe, from a zero of the probe's own. */
  gap_um: number | null;
}

export interface Vibration {
  slow_roll_version: number | null;
  slow_roll_left_out: Record<string, string>;
  limits: VibrationLimits;
  probes: ProbeVibration[];
}

/** An ellipse in the plane of the 1× vector. */
export interface VibrationRegion {
  run_kind: string;
  runs: number;
  centre_real_um_pp: number;
  centre_imaginary_um_pp: number;
  semi_major_um_pp: number;
  semi_minor_um_pp: number;
  inclination_deg: number;
}

export interface ProbeTrend {
  channel: string;
  run: number[];
  run_kind: string[];
  measured_at: string[];
  speed_rpm: number[];
  amplitude_um_pp: Column;
  phase_lag_deg: Column;
  amplitude_2x_um_pp: Column;
  phase_2x_lag_deg: Column;
  second_over_first: Column;
  overall_um_pp: Column;
  zone: (Zone | null)[];
  gap_um: Column;
  within: (boolean | null)[];
  regions: VibrationRegion[];
}

export interface VibrationTrend {
  running_rpm: number | null;
  running_speed_named: boolean;
  slow_roll_version: number | null;
  slow_roll_left_out: Record<string, string>;
  limits: VibrationLimits;
  probes: ProbeTrend[];
}
