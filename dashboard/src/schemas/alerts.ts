// Alerts, their events and evidence, limits and suppressions.
import type { FindingKind, LimitName } from "../findings/findings";

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
  /** What it means and what to do; null, or missing, where the service has no words for its kind. */
  advice?: Advice | null;
  evidence: Partial<Evidence>;
  identification: number;
  measured_at: string;
  first_measured_at: string;
  opened_at: string;
  updated_at: string;
  closed_at: string | null;
  events: number;
}

/** What is told of a finding, in the service's or the site's own texts. */
export interface Advice {
  what: string;
  how_far: { words: string }[];
  how_sure: { words: string };
  how_urgent: { words: string };
  check: string[];
  actions: { opportunity: string; text: string }[];
  confirm: string[];
  not_determined: string[];
}

/** The evidence of a diagnosis; alerts of other kinds hold other fields. */
export interface Evidence {
  kind: string;
  sigma: number;
  since: string;
  runs: number;
  /** Identifications that it was compared with. */
  baseline: number[];
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
  advice?: Advice | null;
  by: string;
  comment: string;
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

/** Limits of an alert or a danger; null is not checked. */
export type Level = Record<LimitName, number | null>;

export interface Rule {
  alert: Level;
  danger: Level | null;
  on_delay: number;
  off_delay: number;
  hysteresis: number;
  latching: boolean;
}

export type Limits = Record<FindingKind, Rule> & { elements: Record<string, Partial<Record<FindingKind, Rule>>> };

export interface LimitsVersion {
  version: number;
  limits: Limits;
  set_at: string | null;
  by: string | null;
  comment: string | null;
}
