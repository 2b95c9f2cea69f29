// Times in the reader's zone, and in UTC.

const DAY = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", year: "numeric" });
const MINUTE = new Intl.DateTimeFormat(undefined, { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit", hourCycle: "h23" });
const SECOND = new Intl.DateTimeFormat(undefined, { hour: "2-digit", minute: "2-digit", second: "2-digit", hourCycle: "h23" });

/** Local time, as short as its distance allows. */
export function when(iso: string): string {
  const at = new Date(iso);
  return Math.abs(Date.now() - at.getTime()) > 300 * 86_400_000 ? DAY.format(at) : MINUTE.format(at);
}

export function clock(ms: number): string {
  return SECOND.format(ms);
}

export function utc(iso: string): string {
  return `${new Date(iso).toISOString().slice(0, 19).replace("T", " ")} UTC`;
}
