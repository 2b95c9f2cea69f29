// Requests to the API, and their errors.
import { lengthUnit } from "../browser/units";
import { joinedSignal } from "./abort-signals";
import { locale } from "../messages/locale";
import { t } from "../messages/messages";
import { connection, isTimeout, noteNoResponse, noteResponse } from "./connection";
import { problemText } from "./problem";
import { csrfHeaders, redirectToLogin } from "./session";
import { inTurn, isComputed } from "./turns";

export const API_PREFIX = "/api/v1";
const TIMEOUT_MS = 20_000;
/** Time limit of requests that need a computation: the service gives one up after a minute, and others may come first. */
const COMPUTED_MS = 300_000;

/** An error response (RFC 9457), or none at all; then the status is 0. */
export class ApiError extends Error {
  constructor(
    readonly status: number,
    message: string,
    /** The service is up, but has not answered this request yet. */
    readonly pending = false,
    /** When to ask again, where the service says it [ms]. */
    readonly retryAfterMs: number | undefined = undefined,
  ) {
    super(message);
  }

  /** Whether the service refused the request for good: any other may be carried out, or answered, yet. */
  get rejected(): boolean {
    return this.status >= 400 && this.status < 500 && this.status !== 429 && !this.pending;
  }

  /** Whether it concerns this request alone: that the service does not answer at all is stated once, above everything. */
  get isLocal(): boolean {
    return this.status > 0 || this.pending;
  }
}

function noResponse(sentAt: number, error: unknown, waitedMs: number): ApiError {
  noteNoResponse(sentAt, error);
  return isTimeout(error) && connection.value.state !== "lost" ? pending(waitedMs) : new ApiError(0, t("theServiceDoesNotAnswer"));
}

function pending(waitedMs = TIMEOUT_MS): ApiError {
  return new ApiError(0, t("theServiceIsUpBut", { seconds: waitedMs / 1000 }), true);
}

/** The language of findings' texts; with the units of the US (Unicode's key `ms` of language tags) their lengths are in mils. */
function acceptLanguage(): string {
  return lengthUnit().label === "mil" ? `${locale}-u-ms-ussystem` : locale;
}

/** Throws what the options' signal was aborted with. */
async function request(path: string, options: RequestInit): Promise<Response> {
  let response: Response;
  const sentAt = Date.now();
  const waitMs = isComputed(path) ? COMPUTED_MS : TIMEOUT_MS;
  try {
    const waited = AbortSignal.timeout(waitMs);
    response = await fetch(API_PREFIX + path, {
      ...options,
      headers: { "accept-language": acceptLanguage(), ...options.headers },
      signal: options.signal ? joinedSignal(options.signal, waited) : waited,
    });
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw noResponse(sentAt, error, waitMs);
  }
  noteResponse(); // even if it is an error: the heartbeat finds out whether the service can read its data
  if (response.ok) return response;
  if (response.status === 401) redirectToLogin();
  const retryAfter = Number(response.headers.get("retry-after")) || undefined;
  const inProgress = response.status === 409 && retryAfter !== undefined;
  throw new ApiError(response.status, await problemText(response), inProgress, retryAfter && 1000 * retryAfter);
}

async function parse<T>(response: Response): Promise<T> {
  try {
    return (await response.json()) as T;
  } catch (error) {
    if (isTimeout(error)) throw pending();
    throw new ApiError(response.status, error instanceof SyntaxError ? t("theServiceSResponseIs") : t("theServiceSResponseWas"));
  }
}

export async function get<T>(path: string, signal?: AbortSignal): Promise<T> {
  const read = async () => parse<T>(await request(path, { headers: { accept: "application/json" }, ...(signal && { signal }) }));
  return isComputed(path) ? inTurn(read) : read();
}

export async function getText(path: string): Promise<string> {
  const response = await request(path, { headers: { accept: "text/csv" } });
  try {
    return await response.text();
  } catch (error) {
    throw isTimeout(error) ? pending() : new ApiError(response.status, t("theServiceSResponseWas"));
  }
}

/** The resource, and the ETag that a change of it must name. */
export async function getWithEtag<T>(path: string): Promise<[T, string | null]> {
  const response = await request(path, { headers: { accept: "application/json" }, cache: "no-store" });
  return [await parse<T>(response), response.headers.get("etag")];
}

/** Idempotency keys by request, of posts that may have been carried out though no response came. */
export type IdempotencyKeys = Map<string, string>;

function newKey(): string {
  return [...crypto.getRandomValues(new Uint32Array(4))].map((one) => one.toString(16)).join("-");
}

/** Post. With the same keys a request that is repeated because no response came is carried out once. */
export async function post<T>(path: string, body: unknown, etag: string | null = null, keys: IdempotencyKeys = new Map()): Promise<T> {
  const request = path + JSON.stringify(body);
  const key = keys.get(request) ?? newKey();
  keys.set(request, key);
  try {
    return await send<T>("POST", path, body, etag, { "idempotency-key": key });
  } catch (error) {
    if (error instanceof ApiError && error.rejected) keys.delete(request);
    throw error;
  }
}

export function put<T>(path: string, body: unknown, etag: string | null): Promise<T> {
  return send<T>("PUT", path, body, etag);
}

/** body: null for none. etag: of the resource that is to be changed. */
async function send<T>(method: string, path: string, body: unknown, etag: string | null, more: Record<string, string> = {}): Promise<T> {
  const headers: Record<string, string> = { accept: "application/json", ...csrfHeaders(), ...more };
  if (body !== null) headers["content-type"] = "application/json";
  if (etag) headers["if-match"] = etag;
  return parse<T>(await request(path, { method, headers, body: body === null ? null : JSON.stringify(body) }));
}

export function queryString(parameters: Record<string, string | number | boolean | null | undefined | string[]>): string {
  const search = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) {
    for (const one of Array.isArray(value) ? value : [value]) {
      if (one !== null && one !== undefined) search.append(name, String(one));
    }
  }
  const text = search.toString();
  return text ? `?${text}` : "";
}
