// Answers of the service that components share: asked for once, kept, and asked for again when there is news.
import { useLayoutEffect } from "preact/hooks";
import { Failure, get } from "./http-client";
import { connection, newestEvent, returns } from "./connection";
import { Store, useStore, useStores } from "../browser/store";

export interface Answer<T> {
  data: T | undefined;
  failure: Failure | undefined;
  /** When the data were answered, where they grow old: it has failed for some time to get newer ones [ms]. */
  asOf?: number | undefined;
}

/** So many answers that nobody follows are kept, for going back and forth. */
const KEPT = 60;
/** What was asked for so shortly before is not asked for again by another component [ms]. */
const FRESH_MS = 1000;
/** What waited for a free connection in vain is asked for again so much later [ms]. */
const AGAIN_MS = 1000;
/** What was refused is asked for again so much later [ms]: soon at first, for one failed try is no news. */
const SOON_MS = 3000;
const LATER_MS = 10_000;
/** Data grow old when it has failed for so long to get newer ones [ms]. */
const LASTING_MS = 2500;

class Resource {
  readonly answer = new Store<Answer<unknown>>({ data: undefined, failure: undefined });
  followers = 0;
  asked = 0;
  private asking = false;
  /** Whether there was news while a question was open, whose answer may be from before. */
  private again = false;
  private answeredAt = 0;
  /** When the first failure in a row was that is of this question alone; null without one [ms]. */
  private refusedAt: number | null = null;
  private retry: number | undefined;

  constructor(readonly path: string) {}

  /** Ask unless a question is open, or was asked since so long. */
  want(sinceMs = FRESH_MS): void {
    if (!this.asking && Date.now() - this.asked >= sinceMs) void this.refresh();
  }

  /** Ask, behind a question that is open. */
  async refresh(): Promise<void> {
    if (this.asking) {
      this.again = true;
      return;
    }
    this.asking = true;
    this.asked = Date.now();
    try {
      this.answer.set({ data: await get(this.path), failure: undefined });
      this.answeredAt = Date.now();
      this.refusedAt = null;
      window.clearTimeout(this.retry);
    } catch (error) {
      this.fail(error instanceof Failure ? error : new Failure(0, String(error)));
    } finally {
      this.asking = false;
    }
    const again = this.again;
    this.again = false;
    if (!again) return;
    if (this.followers > 0) void this.refresh();
    else this.asked = 0; // who comes back asks at once
  }

  private fail(failure: Failure): void {
    this.refusedAt = failure.own ? (this.refusedAt ?? Date.now()) : null;
    const lasts = failure.late || (this.refusedAt !== null && Date.now() - this.refusedAt >= LASTING_MS);
    // What was there stays visible while the service is away; what is gone is gone.
    const data = failure.status === 404 ? undefined : this.answer.value.data;
    this.answer.set({ data, failure, asOf: lasts ? this.answeredAt : undefined });
    const { state } = connection.value;
    if (state === "lost" || state === "troubled") return; // all is asked for again when that is over
    if (failure.status === 0) this.askAgain(AGAIN_MS);
    else if (data !== undefined || !failure.refused) this.askAgain(lasts ? LATER_MS : SOON_MS);
  }

  private askAgain(afterMs: number): void {
    window.clearTimeout(this.retry);
    this.retry = window.setTimeout(() => this.followers > 0 && !document.hidden && void this.refresh(), afterMs);
  }
}

const resources = new Map<string, Resource>();

function resourceOf(path: string): Resource {
  const known = resources.get(path);
  if (known) return known;
  const made = new Resource(path);
  resources.set(path, made);
  return made;
}

/** Never while something is drawn: what that shows is followed only when all of it is there. */
function letGo(): void {
  for (const [path, one] of resources) {
    if (resources.size <= KEPT) break;
    if (one.followers === 0) resources.delete(path);
  }
}

/** Ask for what will be shown in a moment. */
export function foresee(...paths: string[]): void {
  for (const path of paths) resourceOf(path).want();
}

/** Ask again for all that is shown and whose path holds the text. */
export function refresh(text: string): void {
  for (const [path, resource] of resources) {
    if (!path.includes(text)) continue;
    if (resource.followers > 0) void resource.refresh();
    else resources.delete(path);
  }
}

returns.follow(() => refresh(""));
newestEvent.follow(() => {
  refresh("/alerts");
  refresh("/deviations");
  refresh("/fleet");
});

const NOTHING = new Store<Answer<unknown>>({ data: undefined, failure: undefined });

/** Keep an answer up to date until what is returned is called. */
function keep(resource: Resource, everyMs: number): () => void {
  resource.followers += 1;
  resource.want();
  const timer =
    everyMs > 0
      ? window.setInterval(() => {
          if (!document.hidden) resource.want(everyMs * 0.9);
        }, everyMs)
      : undefined;
  return () => {
    resource.followers -= 1;
    window.clearInterval(timer);
    queueMicrotask(letGo);
  };
}

/**
 * What the service answers under a path; nothing for no path.
 *
 * everyMs: asked again as often as this while the page is seen; 0: only on news.
 */
export function useResource<T>(path: string | null, everyMs = 0): Answer<T> {
  const resource = path === null ? null : resourceOf(path);
  useLayoutEffect(() => (resource ? keep(resource, everyMs) : undefined), [resource, everyMs]);
  return useStore(resource ? resource.answer : NOTHING) as Answer<T>;
}

/** The same under each of several paths; asked again only on news. */
export function useResources<T>(paths: string[]): Answer<T>[] {
  const several = paths.map(resourceOf);
  useLayoutEffect(() => {
    const leave = several.map((one) => keep(one, 0));
    return () => leave.forEach((one) => one());
  }, several);
  return useStores(several.map((one) => one.answer)) as Answer<T>[];
}
