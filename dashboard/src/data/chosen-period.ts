// The period that the address names: its first and last day, open at either end.
import { route } from "../browser/router";
import { useStore } from "../browser/store";

const DAY = /^\d{4}-\d{2}-\d{2}$/;

export interface ChosenPeriod {
  /** Days in local time; empty where the period is open. */
  first: string;
  last: string;
  /** The same as instants for the API. */
  from: string | null;
  to: string | null;
}

export function usePeriod(): ChosenPeriod {
  const { query } = useStore(route);
  const [first, last] = [query.get("from") ?? "", query.get("to") ?? ""];
  const begin = DAY.test(first) ? new Date(`${first}T00:00`) : null;
  const end = DAY.test(last) ? new Date(`${last}T23:59:59.999`) : null;
  const valid = (at: Date | null) => at !== null && !Number.isNaN(at.getTime());
  const ordered = !valid(begin) || !valid(end) || begin! <= end!;
  return { first, last, from: ordered && valid(begin) ? begin!.toISOString() : null, to: ordered && valid(end) ? end!.toISOString() : null };
}
