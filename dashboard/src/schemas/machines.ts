// Machines: documents, states, the drawing of the train, the fleet, the timeline.

/** Positive turns +x towards +y. */
export type Sense = "positive" | "negative";

export interface Document {
  id: string;
  plant: string;
  name: string;
  rotation?: Sense;
  operation?: { running_rpm?: number | null };
  speed_range: { minimum_rpm: number; maximum_rpm: number };
  couplings: { id: string }[];
  /** film: the film from which a journal bearing's coefficients follow. */
  bearings: { id: string; film?: { profile?: string; preload?: number; oil: { supply?: string | null } } | null }[];
  seals?: { id: string }[];
  pedestals?: { id: string }[];
  shafts: { id: string }[];
  static_loads?: { id: string }[];
  discs: { id: string }[];
  probes: { id: string }[];
}

export interface MachineRevision {
  id: string;
  revision: number;
  created_at: string;
  document: Document;
  /** What is hardly meant in the document, a line each: `bearings[0].speed_dependence.speed_rpm: the table covers …`. */
  warnings: string[];
}

/** Whether the train as its document describes it would whirl, or its journals touch, within its speed range. */
export interface Stability {
  machine: string;
  revision: number;
  /** Warnings like those of the revision; none for a machine that would run. */
  warnings: string[];
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
  /** What is probably wrong where it turns, but never was in its document's speed range. */
  outside_speed_range?: string | null;
  late_samples_waiting?: number;
}

export interface TimelineEntry {
  id: number;
  at: string;
  kind: string;
  text: string;
  by: string;
}

export interface Drawing {
  length: number;
  sections: { shaft: string; begin: number; end: number; outer_diameter: number; inner_diameter: number }[];
  discs: { element: string; at: number; radius: number | null; width: number | null }[];
  bearings: { element: string; at: number }[];
  seals: { element: string; at: number }[];
  pedestals: { element: string; at: number }[];
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
  /** The open alert to look at first. */
  first_alert: { id: number; severity: string; rule: string; element: string; state: string } | null;
  /** Why it has no run, where it turns outside of its speed range. */
  outside_speed_range: string | null;
  /** A 1× beyond the danger limit at running speed, or for long, until it is below again at running speed [µm pp]. */
  vibration_beyond_danger: {
    channel: string;
    amplitude_um_pp: number;
    danger_um_pp: number;
    speed_rpm: number;
    first_at: string;
    last_at: string;
  } | null;
  /** An identification that failed, after which none has ended well. */
  failed_job: { id: number; error: string | null } | null;
  happened: Record<"runs" | "identifications" | "alert_events" | "revisions" | "timeline" | "refused", number>;
}

export interface Fleet {
  since: string;
  machines: FleetMachine[];
}
