// The newest identification of a machine: the newest accepted one of a single run, else the newest of all.
import { useRef } from "preact/hooks";
import type { Identification, IdentificationSummary } from "../schemas/identifications";
import type { ApiError } from "./http-client";
import { useResource, useResources, type QueryResult } from "./resource";

const POLL_MS = 15_000;
/** Searched for an accepted one, at first and if there is none among these. */
const FIRST_SEARCH = 20;
/** The API's limit for a page of identifications. */
export const MAX_SEARCH = 1000;

export interface NewestSummary extends QueryResult<IdentificationSummary | null> {
  searched: number;
}

/** Its data are undefined while nothing is known, and null where nothing was identified. */
export function useNewestSummary(machine: string): NewestSummary {
  const newest = useResource<IdentificationSummary[]>(listPath(machine, FIRST_SEARCH), POLL_MS);
  const searchFurther = !newest.data?.some(isComparable) && newest.data?.length === FIRST_SEARCH;
  const more = useResource<IdentificationSummary[]>(searchFurther ? listPath(machine, MAX_SEARCH) : null);
  const { data, failure, asOf } = searchFurther ? more : newest;
  return { data: data && (data.find(isComparable) ?? newest.data?.[0] ?? null), failure, asOf, searched: data?.length ?? 0 };
}

function listPath(machine: string, limit: number): string {
  return `/machines/${machine}/identifications?limit=${limit}`;
}

/** Whether it can be compared with a baseline. */
export function isComparable(one: IdentificationSummary | null | undefined): one is IdentificationSummary {
  return !!one && one.accepted && one.scope === "run";
}

export interface NewestIdentification {
  newest: Identification | undefined;
  /** Whether nothing was identified. */
  none: boolean;
  /** Why there is none, or not the next one. */
  failure: ApiError | undefined;
  /** The list that it was found in. */
  list: QueryResult<unknown>;
}

/** The newest one with its estimates; the one before it until every part that the view needs of the next one is loaded. */
export function useNewestIdentification(machine: string, partPaths: (id: number) => string[] = () => []): NewestIdentification {
  const list = useNewestSummary(machine);
  const { data, failure } = list;
  const next = useResource<Identification>(data ? `/identifications/${data.id}` : null);
  const parts = useResources<unknown>(next.data ? partPaths(next.data.id) : []);
  const shown = useRef<Identification | undefined>(undefined);
  // A part that is rejected for good is not waited for: the view says why it is not there.
  const isComplete = parts.every((one) => one.data !== undefined || one.failure?.rejected);
  if (next.data && (isComplete || !shown.current)) shown.current = next.data;
  const missing = next.data ? parts.find((one) => shown.current !== next.data && one.failure)?.failure : (next.failure ?? failure);
  return { newest: shown.current, none: data === null, failure: missing, list };
}

/** The newest one of a list, with its estimates. */
export function useNewestOf(found: IdentificationSummary[] | undefined): QueryResult<Identification> {
  const one = found?.find(isComparable) ?? found?.[0];
  return useResource<Identification>(one ? `/identifications/${one.id}` : null);
}
