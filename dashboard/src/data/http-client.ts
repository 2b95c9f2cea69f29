// Asking the service, and what is said when it refuses.
import { connection, heard, missed, timedOut } from "./connection";
import { reason } from "./problem";
import { changeHeaders, refused } from "./session";

export const PREFIX = "/api/v1";
const PATIENCE_MS = 20_000;

/** The service's problem detail (RFC 9457), or that it did not answer; then the status is 0. */
export class Failure extends Error {
  constructor(
    readonly status: number,
    message: string,
    /** The service is there, but its answer is not yet. */
    readonly late = false,
  ) {
    super(message);
  }

  /** Whether the service said that it does not do this: else it may be done, or answered, yet. */
  get refused(): boolean {
    return this.status >= 400 && this.status < 500 && this.status !== 429 && !this.late;
  }

  /** Whether it is of this question alone: that nobody answers at all is said once, above everything. */
  get own(): boolean {
    return this.status > 0 || this.late;
  }
}

function unanswered(asked: number, error: unknown): Failure {
  missed(asked, error);
  return timedOut(error) && connection.value.state !== "lost" ? late() : new Failure(0, "The service does not answer.");
}

function late(): Failure {
  return new Failure(0, `The service is there, but has not answered this within ${PATIENCE_MS / 1000} s.`, true);
}

async function ask(path: string, options: RequestInit): Promise<Response> {
  let response: Response;
  const asked = Date.now();
  try {
    response = await fetch(PREFIX + path, { ...options, signal: AbortSignal.timeout(PATIENCE_MS) });
  } catch (error) {
    throw unanswered(asked, error);
  }
  heard(); // even if it refuses: whether it can read its data is told by the beat
  if (response.ok) return response;
  if (response.status === 401) refused();
  const underWay = response.status === 409 && response.headers.has("retry-after");
  throw new Failure(response.status, await reason(response), underWay);
}

async function read<T>(response: Response): Promise<T> {
  try {
    return (await response.json()) as T;
  } catch (error) {
    if (timedOut(error)) throw late();
    throw new Failure(response.status, error instanceof SyntaxError ? "The service's answer is no JSON." : "The service's answer broke off.");
  }
}

export async function get<T>(path: string): Promise<T> {
  return read<T>(await ask(path, { headers: { accept: "application/json" } }));
}

/** The answer, and the ETag with which it can be changed. */
export async function getToChange<T>(path: string): Promise<[T, string | null]> {
  const response = await ask(path, { headers: { accept: "application/json" }, cache: "no-store" });
  return [await read<T>(response), response.headers.get("etag")];
}

/** One attempt of a person, by what was asked: the keys of posts that may have been carried out though no answer came. */
export type Attempt = Map<string, string>;

function newKey(): string {
  return [...crypto.getRandomValues(new Uint32Array(4))].map((one) => one.toString(16)).join("-");
}

/** What is asked again in the same attempt after no answer came goes under the key of before, and is done once. */
export async function post<T>(path: string, body: unknown, etag: string | null = null, attempt: Attempt = new Map()): Promise<T> {
  const asked = path + JSON.stringify(body);
  const key = attempt.get(asked) ?? newKey();
  attempt.set(asked, key);
  try {
    return await send<T>("POST", path, body, etag, { "idempotency-key": key });
  } catch (error) {
    if (error instanceof Failure && error.refused) attempt.delete(asked);
    throw error;
  }
}

export function put<T>(path: string, body: unknown, etag: string | null): Promise<T> {
  return send<T>("PUT", path, body, etag);
}

/** body: null for none. etag: of what is to be changed. */
async function send<T>(method: string, path: string, body: unknown, etag: string | null, more: Record<string, string> = {}): Promise<T> {
  const headers: Record<string, string> = { accept: "application/json", ...changeHeaders(), ...more };
  if (body !== null) headers["content-type"] = "application/json";
  if (etag) headers["if-match"] = etag;
  return read<T>(await ask(path, { method, headers, body: body === null ? null : JSON.stringify(body) }));
}

export function query(parameters: Record<string, string | number | boolean | null | undefined | string[]>): string {
  const search = new URLSearchParams();
  for (const [name, value] of Object.entries(parameters)) {
    for (const one of Array.isArray(value) ? value : [value]) {
      if (one !== null && one !== undefined) search.append(name, String(one));
    }
  }
  const text = search.toString();
  return text ? `?${text}` : "";
}
