// Days of the calendar in local time, as date fields write them.

export function dayOf(at: Date): string {
  return new Date(at.getTime() - at.getTimezoneOffset() * 60_000).toISOString().slice(0, 10);
}

export function midnight(day: string): Date {
  return new Date(`${day}T00:00`);
}

/** Midnight so many days later: not all days have 24 hours. */
export function daysLater(at: Date, days: number): Date {
  return new Date(at.getFullYear(), at.getMonth(), at.getDate() + days);
}

/** Whether a text is a day of the calendar. */
export function isDay(text: string): boolean {
  const at = midnight(text);
  return !Number.isNaN(at.getTime()) && dayOf(at) === text;
}
