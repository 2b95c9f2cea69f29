// Times in the reader's zone, in one form everywhere, and in UTC.

function two(value: number): string {
  return String(value).padStart(2, "0");
}

/** `2026-11-26` in local time. */
export function date(at: Date): string {
  return `${at.getFullYear()}-${two(at.getMonth() + 1)}-${two(at.getDate())}`;
}

/** `2026-11-26 11:26` in local time. */
export function when(iso: string): string {
  const at = new Date(iso);
  return `${date(at)} ${two(at.getHours())}:${two(at.getMinutes())}`;
}

/** A time as `when` writes it, of local time; undefined for anything else. */
export function minuteOf(text: string): Date | undefined {
  const at = /^\d{4}-\d{2}-\d{2} \d{2}:\d{2}$/.test(text) ? new Date(text.replace(" ", "T")) : null;
  return at && !Number.isNaN(at.getTime()) && date(at) === text.slice(0, 10) ? at : undefined;
}

/** Whether a text is such a time; one that a clock skips is one. */
export function isMinute(text: string): boolean {
  return minuteOf(text) !== undefined;
}

/** `11:26:05` in local time. */
export function clock(ms: number): string {
  const at = new Date(ms);
  return `${two(at.getHours())}:${two(at.getMinutes())}:${two(at.getSeconds())}`;
}

export function utc(iso: string): string {
  return `${new Date(iso).toISOString().slice(0, 19).replace("T", " ")} UTC`;
}
