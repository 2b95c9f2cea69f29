// A cache of the API's resources that components share: requested once, kept, and requested again when something changed.
import { useLayoutEffect } from "preact/hooks";
import { Store, useStore, useStores } from "../browser/store";
import { unitChoice } from "../browser/units";
import { connection, latestAlertEvent, reconnects } from "./connection";
import { ApiError, get } from "./http-client";
import { isComputed } from "./turns";

export interface QueryResult<T> {
  data: T | undefined;
  failure: ApiError | undefined;
  /** When the data were received, where they are stale: newer ones could not be loaded for some time [ms]. */
  asOf?: number | undefined;
}

/** Resources without a subscriber that are kept, for going back and forth. */
const MAX_UNUSED = 60;
/** Younger data are not requested again for another component [ms]. */
const FRESH_MS = 1000;
/** Time until a retry when no free connection was found [ms]. */
const RETRY_MS = 1000;
/** Time until a retry after an error [ms]: short at first, since a single failed attempt is not reported. */
const RETRY_SOON_MS = 3000;
const RETRY_LATER_MS = 10_000;
/** Time until a failed computation is requested again [ms]: the service would try as long as before. */
const RETRY_COMPUTED_MS = 120_000;
/** Data are stale when newer ones could not be loaded for so long [ms]. */
const STALE_AFTER_MS = 2500;

class Resource {
  readonly result = new Store<QueryResult<unknown>>({ data: undefined, failure: undefined });
  subscribers = 0;
  requestedAt = 0;
  private inFlight: Promise<void> | null = null;
  /** The request after that in flight, whose response may be from before something changed. */
  private following: Promise<void> | null = null;
  private receivedAt = 0;
  /** When the first of the latest errors in a row occurred that concern this request alone; null without one [ms]. */
  private failingSince: number | null = null;
  private retry: number | undefined;
  private abort = new AbortController();

  constructor(readonly path: string) {}

  /** Request unless a request is in flight or was sent within that time. */
  fetchIfOlder(ms = FRESH_MS): void {
    if (this.inFlight === null && Date.now() - this.requestedAt >= ms) void this.fetch();
  }

  /** Request, after a request that is in flight; resolved, whatever the response, once it is there. */
  fetch(): Promise<void> {
    if (!this.inFlight) return (this.inFlight = this.request());
    this.following ??= this.inFlight.then(() => {
      this.following = null;
      if (this.subscribers > 0) return this.fetch();
      this.requestedAt = 0; // the next subscriber requests at once
      return undefined;
    });
    return this.following;
  }

  private async request(): Promise<void> {
    this.requestedAt = Date.now();
    this.abort = new AbortController();
    const { signal } = this.abort;
    try {
      this.result.set({ data: await get(this.path, signal), failure: undefined });
      this.receivedAt = Date.now();
      this.failingSince = null;
      window.clearTimeout(this.retry);
    } catch (error) {
      if (signal.aborted) this.requestedAt = 0;
      else this.fail(error instanceof ApiError ? error : new ApiError(0, String(error)));
    } finally {
      this.inFlight = null;
    }
    if (signal.aborted && this.subscribers > 0 && !this.following) void this.fetch();
  }

  /** Give up a request that the service may still compute for: it keeps the result of what it has begun. */
  abandon(): void {
    if (this.inFlight !== null && isComputed(this.path)) this.abort.abort();
  }

  private fail(failure: ApiError): void {
    this.failingSince = failure.isLocal ? (this.failingSince ?? Date.now()) : null;
    const isStale = failure.pending || (this.failingSince !== null && Date.now() - this.failingSince >= STALE_AFTER_MS);
    // Data stay visible while the service is away; a resource that was deleted does not.
    const data = failure.status === 404 ? undefined : this.result.value.data;
    this.result.set({ data, failure, asOf: isStale ? this.receivedAt : undefined });
    const { state } = connection.value;
    if (state === "lost" || state === "degraded") return; // everything is requested again when that is over
    if (failure.status === 0) this.scheduleRetry(RETRY_MS);
    else if (failure.status === 503 && isComputed(this.path)) this.scheduleRetry(failure.retryAfterMs ?? RETRY_COMPUTED_MS);
    else if (data !== undefined || !failure.rejected) this.scheduleRetry(isStale ? RETRY_LATER_MS : RETRY_SOON_MS);
  }

  private scheduleRetry(afterMs: number): void {
    window.clearTimeout(this.retry);
    this.retry = window.setTimeout(() => this.subscribers > 0 && !document.hidden && void this.fetch(), afterMs);
  }
}

const resources = new Map<string, Resource>();

function resourceOf(path: string): Resource {
  const cached = resources.get(path);
  if (cached) return cached;
  const created = new Resource(path);
  resources.set(path, created);
  return created;
}

/** Never call this during rendering: components subscribe only after it. */
function evictUnused(): void {
  for (const [path, one] of resources) {
    if (resources.size <= MAX_UNUSED) break;
    if (one.subscribers === 0) resources.delete(path);
  }
}

/** Request what will be shown in a moment. */
export function prefetch(...paths: string[]): void {
  for (const path of paths) resourceOf(path).fetchIfOlder();
}

/** Request again every shown resource whose path contains the text; resolved once all have answered. */
export async function refetch(text: string): Promise<void> {
  const requested: Promise<void>[] = [];
  for (const [path, resource] of resources) {
    if (!path.includes(text)) continue;
    if (resource.subscribers > 0) requested.push(resource.fetch());
    else resources.delete(path);
  }
  await Promise.all(requested);
}

reconnects.subscribe(() => {
  for (const one of resources.values()) one.abandon(); // the connection that its answer was to come by may be gone
  void refetch("");
});
unitChoice.subscribe(() => void refetch("")); // sentences of findings tell lengths in the unit that is chosen
latestAlertEvent.subscribe(() => {
  void refetch("/alerts");
  void refetch("/deviations");
  void refetch("/fleet");
});

const NOTHING = new Store<QueryResult<unknown>>({ data: undefined, failure: undefined });

/** Keep a resource up to date until the returned function is called. */
function subscribe(resource: Resource, everyMs: number): () => void {
  resource.subscribers += 1;
  resource.fetchIfOlder();
  const timer =
    everyMs > 0
      ? window.setInterval(() => {
          if (!document.hidden) resource.fetchIfOlder(everyMs * 0.9);
        }, everyMs)
      : undefined;
  return () => {
    resource.subscribers -= 1;
    window.clearInterval(timer);
    queueMicrotask(() => {
      if (resource.subscribers === 0) resource.abandon();
      evictUnused();
    });
  };
}

/**
 * The resource at a path; nothing for no path.
 *
 * everyMs: how often it is polled while the tab is visible; 0: only after changes.
 */
export function useResource<T>(path: string | null, everyMs = 0): QueryResult<T> {
  const resource = path === null ? null : resourceOf(path);
  useLayoutEffect(() => (resource ? subscribe(resource, everyMs) : undefined), [resource, everyMs]);
  return useStore(resource ? resource.result : NOTHING) as QueryResult<T>;
}

/** The resources at several paths, requested again only after changes. */
export function useResources<T>(paths: string[]): QueryResult<T>[] {
  const several = paths.map(resourceOf);
  useLayoutEffect(() => {
    const unsubscribe = several.map((one) => subscribe(one, 0));
    return () => unsubscribe.forEach((one) => one());
  }, several);
  return useStores(several.map((one) => one.result)) as QueryResult<T>[];
}
