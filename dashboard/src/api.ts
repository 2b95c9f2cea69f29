// Asking the service, and what is said when it refuses.
import { heard, missed } from "./connection";
import { reason } from "./problem";
import { changeHeaders, refused } from "./session";

export const PREFIX = "/api/v1";
const PATIENCE_MS = 20_000;

/** The service's problem detail (RFC 9457), or that it did not answer; then the status is 0. */
export class Failure extends Error {
  constructor(
    readonly status: number,
    message: string,
  ) {
    super(message);
  }
}

async function ask(path: string, options: RequestInit): Promise<Response> {
  let response: Response;
  const asked = Date.now();
  try {
    response = await fetch(PREFIX + path, { ...options, signal: AbortSignal.timeout(PATIENCE_MS) });
  } catch (error) {
    missed(asked, error);
    throw new Failure(0, "The service does not answer.");
  }
  heard(); // even if it refuses: whether it can read its data is told by the beat
  if (response.ok) return response;
  if (response.status === 401) refused();
  throw new Failure(response.status, await reason(response));
}

export async function get<T>(path: string): Promise<T> {
  return (await (await ask(path, { headers: { accept: "application/json" } })).json()) as T;
}

/** The answer, and the ETag with which it can be changed. */
export async function getToChange<T>(path: string): Promise<[T, string | null]> {
  const response = await ask(path, { headers: { accept: "application/json" }, cache: "no-store" });
  return [(await response.json()) as T, response.headers.get("etag")];
}

export function post<T>(path: string, body: unknown, etag: string | null = null): Promise<T> {
  return send<T>("POST", path, body, etag);
}

export function put<T>(path: string, body: unknown, etag: string | null): Promise<T> {
  return send<T>("PUT", path, body, etag);
}

/** body: null for none. etag: of what is to be changed. */
async function send<T>(method: string, path: string, body: unknown, etag: string | null): Promise<T> {
  const headers: Record<string, string> = { accept: "application/json", ...changeHeaders() };
  if (body !== null) headers["content-type"] = "application/json";
  if (etag) headers["if-match"] = etag;
  return (await (await ask(path, { method, headers, body: body === null ? null : JSON.stringify(body) })).json()) as T;
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
