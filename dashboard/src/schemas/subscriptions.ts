// Subscriptions to alerts and their deliveries.

export type ReportInterval = "weekly" | "monthly";

export interface Subscription {
  id: number;
  kind: string;
  name: string;
  target: string;
  state: string;
  reason: string | null;
  reports: ReportInterval | null;
  created_at: string;
}

/** secret: secret of a webhook, shown once. */
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
