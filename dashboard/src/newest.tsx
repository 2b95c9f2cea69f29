// The identification that speaks for a machine now.
import type { Estimate, Identification, IdentificationSummary } from "./answers";
import { Empty, Panel } from "./parts";
import { useResource, type Answer } from "./resource";

const MS = 15_000;
/** Looked through for an accepted one, first and then. */
const LOOKED_AT = 20;
/** The service answers with so many at most. */
const MOST_LOOKED_AT = 1000;

interface NewestSummary extends Answer<IdentificationSummary | null> {
  lookedAt: number;
}

/** The newest accepted identification of a single run, or the newest of all; undefined while nothing is known. */
export function useNewestSummary(machine: string): NewestSummary {
  const newest = useResource<IdentificationSummary[]>(listOf(machine, LOOKED_AT), MS);
  const among = newest.data?.find(comparable);
  const further = !among && newest.data?.length === LOOKED_AT;
  const more = useResource<IdentificationSummary[]>(further ? listOf(machine, MOST_LOOKED_AT) : null);
  const { data, failure, asOf } = further ? more : newest;
  return { data: data && (among ?? data.find(comparable) ?? data[0] ?? null), failure, asOf, lookedAt: data?.length ?? 0 };
}

function listOf(machine: string, limit: number): string {
  return `/machines/${machine}/identifications?limit=${limit}`;
}

/** Whether it can be compared with a baseline. */
export function comparable(one: IdentificationSummary | null | undefined): one is IdentificationSummary {
  return !!one && one.accepted && one.scope === "run";
}

/** That none can be compared, in words; null where one can, or nothing is known. */
export function noneAccepted({ data, lookedAt }: NewestSummary): string | null {
  if (data === undefined || comparable(data)) return null;
  if (lookedAt === MOST_LOOKED_AT) return `Of the newest ${MOST_LOOKED_AT} identifications none of a single run was accepted.`;
  return "No identification of a single run was accepted yet.";
}

/** The newest one with its estimates. */
export function useNewest(machine: string): { newest: Identification | undefined; none: boolean; failure: string | undefined } {
  const { data, failure } = useNewestSummary(machine);
  const answer = useResource<Identification>(data ? `/identifications/${data.id}` : null);
  return { newest: answer.data, none: data === null, failure: (failure ?? answer.failure)?.message };
}

/** The newest accepted identification of a single run among some, or the newest of all, with its estimates. */
export function useNewestOf(found: IdentificationSummary[] | undefined): Identification | undefined {
  const one = found?.find((each) => each.accepted && each.scope === "run") ?? found?.[0];
  return useResource<Identification>(one ? `/identifications/${one.id}` : null).data;
}

export function NotIdentified() {
  return (
    <Panel title="Nothing to show yet">
      <Empty>No run of this machine was identified yet. The first one that covers enough of the speed range will be.</Empty>
    </Panel>
  );
}

export function elementsOf(estimates: Estimate[]): string[] {
  return [...new Set(estimates.map((one) => one.element))];
}
