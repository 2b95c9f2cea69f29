// Runs and what was measured in them: phasors and orbits.

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

export interface Phasors {
  channels: string[];
  time: string[];
  speed_rpm: number[];
  amplitude_um_pp: (number | null)[][];
  phase_lag_deg: (number | null)[][];
  amplitude_2x_um_pp?: (number | null)[][] | null;
  phase_2x_lag_deg?: (number | null)[][] | null;
  /** Vectors that were subtracted; null: raw. */
  slow_roll_version: number | null;
  slow_roll_left_out: Record<string, string>;
}

export interface AxisPhasor {
  real_um: number;
  imaginary_um: number;
}

export interface Orbit {
  shaft: string;
  station: number;
  channels: string[];
  /** Angles of the probes, from +x towards +y [°]. */
  angles_deg: number[];
  speed_rpm: number;
  x: AxisPhasor;
  y: AxisPhasor;
  x_2x: AxisPhasor | null;
  y_2x: AxisPhasor | null;
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
