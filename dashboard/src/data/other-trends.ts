// The histories of another machine, beside those of the one that is looked at.
import type { IdentificationSummary } from "../schemas/identifications";
import type { Series, Trends } from "../schemas/trends";
import { queryString } from "./http-client";
import { useNewestOf } from "./newest-identification";
import { useResource } from "./resource";

const POLL_MS = 30_000;

export interface OtherTrends {
  series: Series[];
  /** Those of the parameters that the other machine has. */
  names: string[];
  isPending: boolean;
}

/** The histories of another machine, of those parameters that it has too. */
export function useOtherTrends(machine: string | undefined, query: { parameter: string[]; from: string | null; to: string | null; scope: string; max_points: number }): OtherTrends {
  const path = machine ? `/machines/${encodeURIComponent(machine)}` : null;
  const list = useResource<IdentificationSummary[]>(path && `${path}/identifications?limit=20`);
  const newest = useNewestOf(list.data);
  const known = newest.data ? [...newest.data.estimates.map((one) => one.parameter), ...newest.data.derived.map((one) => one.name)] : [];
  const names = query.parameter.filter((one) => known.includes(one));
  const trends = useResource<Trends>(path && names.length > 0 ? `${path}/trends${queryString({ ...query, parameter: names })}` : null, POLL_MS);
  const isKnown = !path || list.failure || list.data?.length === 0 || newest.failure || (newest.data && (names.length === 0 || trends.data || trends.failure));
  return { series: trends.data?.series ?? [], names, isPending: !isKnown };
}
