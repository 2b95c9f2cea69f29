// The service itself: its quarantine.

export interface QuarantineEntry {
  id: number;
  received_at: string;
  machine: string | null;
  reason: string;
  detail: string;
}

export interface Quarantine {
  entries: QuarantineEntry[];
}
