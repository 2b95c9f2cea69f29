// The identification that speaks for a machine now.
import type { Estimate, Identification, IdentificationSummary } from "./answers";
import { Empty, Panel } from "./parts";
import { useResource, type Answer } from "./resource";

const MS = 15_000;
/** Looked through for an accepted one. */
const LOOKED_AT = 20;

/** The newest accepted identification of a single run, or the newest of all; undefined while nothing is known. */
export function useNewestSummary(machine: string): Answer<IdentificationSummary | null> {
  const { data, failure, asOf } = useResource<IdentificationSummary[]>(`/machines/${machine}/identifications?limit=${LOOKED_AT}`, MS);
  return { data: data && (data.find((one) => one.accepted && one.scope === "run") ?? data[0] ?? null), failure, asOf };
}

/** Whether it can be compared with a baseline. */
export function comparable(one: IdentificationSummary | null | undefined): one is IdentificationSummary {
  return !!one && one.accepted && one.scope === "run";
}

/** The same with its estimates. */
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
