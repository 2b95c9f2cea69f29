// Field balancings of a machine: the steps taken so far.

export type Counted = "x-to-y" | "with-rotation" | "against-rotation";

/** scale_deg: the angle on the disc's scale. */
export interface Weight {
  disc: string;
  g_mm: number;
  angle_deg: number;
  scale_deg: number;
}

export interface CorrectionPlane extends Weight {
  lower_g_mm: number;
  upper_g_mm: number;
  half_width_deg: number;
  masses: { angle_deg: number; scale_deg: number; grams: number }[];
  missed: number | null;
}

export type BalanceVerdict = "met" | "not met" | "open";

/** untold: why it is not known; its numbers are null then. */
export interface Residual {
  g_mm: number | null;
  upper_g_mm: number | null;
  reached_grade: number | null;
  verdict: BalanceVerdict | "not known";
  untold: string;
}

interface BearingPlane {
  shaft: string;
  bearing: string;
  permissible_g_mm: number;
}

export interface Vector {
  amplitude_um_pp: number;
  lag_deg: number;
}

/** A measuring point, a channel at a speed. radius_um_pp: of the prediction's 95 % circle. */
export interface PointVectors {
  point: string;
  channel: string;
  runs: (Vector & { name: string })[];
  predicted: Vector;
  radius_um_pp: number;
}

export interface ProposedCorrection {
  by: string;
  at: string;
  speeds_rpm: number[];
  criterion: string;
  grade: number;
  service_rpm: number;
  influence: string;
  notes: string[];
  planes: CorrectionPlane[];
  channels: { channel: string; before_um_pp: number; after_um_pp: number; upper_um_pp: number }[];
  limit_um_pp: number | null;
  limit_verdict: BalanceVerdict | null;
  residual: (BearingPlane & { before: Residual; after: Residual })[];
  vectors: PointVectors[];
}

export interface CheckRun {
  by: string;
  at: string;
  run: number;
  /** All that was on; null where those proposed were. */
  weights: Weight[] | null;
  points: number;
  points_kept: number;
  /** Whether others than those proposed were on; null, as the bounds, where an older release computed it. */
  other_weights: boolean | null;
  channels: { channel: string; check_um_pp: number | null; upper_um_pp: number | null; kept: boolean | null }[];
  limit_met: boolean | null;
  residual: (BearingPlane & Residual)[];
  /** Discs that had weights and no trial run: nothing is predicted then. */
  unpredicted: string[];
  trim: Weight[];
  /** Whether nothing to trim can be told from noise; null where an older release computed it. */
  trim_is_noise: boolean | null;
  vectors: (Vector & { point: string })[];
}

/** A trial run that was taken back. */
export interface WithdrawnTrial {
  run: number;
  weights: Weight[];
  withdrawn_by: string;
  comment: string;
  at: string;
}

export interface FieldBalancing {
  id: number;
  machine: string;
  state: "begun" | "tried" | "proposed" | "checked";
  by: string;
  comment: string;
  created_at: string;
  /** The scale on which angles of weights are told. */
  disc_scale: { counted: Counted; zero_deg: number };
  initial: number[];
  trials: { run: number; weights: Weight[]; by: string }[];
  withdrawn: WithdrawnTrial[];
  correction: ProposedCorrection | null;
  check: CheckRun | null;
}
