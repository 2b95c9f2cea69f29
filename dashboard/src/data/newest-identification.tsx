// The identification that speaks for a machine now.
import { useRef } from "preact/hooks";
import type { Estimate, Identification, IdentificationSummary } from "../schemas/answers";
import type { Failure } from "./http-client";
import { Aging, Empty, Panel, Trouble } from "../components/parts";
import { useResource, useResources, type Answer } from "./resource";

const MS = 15_000;
/** Looked through for an accepted one, first and then. */
const LOOKED_AT = 20;
/** The service answers with so many at most. */
const MOST_LOOKED_AT = 1000;

export interface NewestSummary extends Answer<IdentificationSummary | null> {
  lookedAt: number;
}

/** The newest accepted identification of a single run, or the newest of all; undefined while nothing is known. */
export function useNewestSummary(machine: string): NewestSummary {
  const newest = useResource<IdentificationSummary[]>(listOf(machine, LOOKED_AT), MS);
  const further = !newest.data?.some(comparable) && newest.data?.length === LOOKED_AT;
  const more = useResource<IdentificationSummary[]>(further ? listOf(machine, MOST_LOOKED_AT) : null);
  const { data, failure, asOf } = further ? more : newest;
  return { data: data && (data.find(comparable) ?? newest.data?.[0] ?? null), failure, asOf, lookedAt: data?.length ?? 0 };
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

interface Newest {
  newest: Identification | undefined;
  none: boolean;
  /** Why there is none, or not the next one. */
  failure: Failure | undefined;
  /** What it was found in. */
  listed: Answer<unknown>;
}

/** The newest one with its estimates; the one before it until all is there that a view asks of the next one. */
export function useNewest(machine: string, asked: (id: number) => string[] = () => []): Newest {
  const listed = useNewestSummary(machine);
  const { data, failure } = listed;
  const next = useResource<Identification>(data ? `/identifications/${data.id}` : null);
  const parts = useResources<unknown>(next.data ? asked(next.data.id) : []);
  const shown = useRef<Identification | undefined>(undefined);
  // A part that is refused for good is not waited for: the view says why it is not there.
  const complete = parts.every((one) => one.data !== undefined || one.failure?.refused);
  if (next.data && (complete || !shown.current)) shown.current = next.data;
  const missing = next.data ? parts.find((one) => shown.current !== next.data && one.failure)?.failure : (next.failure ?? failure);
  return { newest: shown.current, none: data === null, failure: missing, listed };
}

/** The newest accepted identification of a single run among some, or the newest of all, with its estimates. */
export function useNewestOf(found: IdentificationSummary[] | undefined): Answer<Identification> {
  const one = found?.find((each) => each.accepted && each.scope === "run") ?? found?.[0];
  return useResource<Identification>(one ? `/identifications/${one.id}` : null);
}

/** In the place of a view whose identification is not there yet. */
export function Awaited({ title, failure }: { title: string; failure: Failure | undefined }) {
  return <Panel title={title}>{failure?.own ? <Trouble failure={failure} /> : <div class="waiting" style={{ minHeight: "420px" }} />}</Panel>;
}

/** Above a view: why it does not show the next identification, or of when the newest is. */
export function Behind({ failure, listed }: Pick<Newest, "failure" | "listed">) {
  return failure?.own ? <Trouble failure={failure} /> : <Aging answer={listed} />;
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
