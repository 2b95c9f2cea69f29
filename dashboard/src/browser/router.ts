// The route, in the address behind the #: /machines/motor-pump/trends?element=coupling.C1
import { Store } from "./store";

export interface Route {
  parts: string[];
  query: URLSearchParams;
}

type Query = Record<string, string | null | undefined>;

function currentRoute(): Route {
  const [path = "", search = ""] = window.location.hash.replace(/^#/, "").split("?", 2);
  return { parts: path.split("/").filter(Boolean).map(decoded), query: new URLSearchParams(search) };
}

/** An address cut off within an escape sequence still leads somewhere. */
function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

export const route = new Store<Route>(currentRoute());
let routedHash = window.location.hash;

function update(): void {
  routedHash = window.location.hash;
  route.set(currentRoute());
}

export function startRouter(): void {
  window.addEventListener("hashchange", update);
}

export function link(parts: string[], query: Query = {}): string {
  const search = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) if (value) search.set(name, value);
  const text = search.toString();
  return `#/${parts.map(encodeURIComponent).join("/")}${text ? `?${text}` : ""}`;
}

/** Change parts of the query without a new entry in the history. */
export function replaceQuery(changes: Record<string, string | null>): void {
  if (window.location.hash !== routedHash) return; // the user has navigated on: do not bring them back
  const { parts, query } = route.value;
  const next = Object.fromEntries([...query.entries(), ...Object.entries(changes)]);
  window.history.replaceState(null, "", link(parts, next));
  update();
}

export function navigate(parts: string[], query: Query = {}): void {
  window.location.hash = link(parts, query);
}
