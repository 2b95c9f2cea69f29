// Where in the page one is, in the address behind the #: /machines/motor-pump/trends?element=coupling.C1
import { Store } from "./store";

export interface Place {
  parts: string[];
  query: URLSearchParams;
}

function here(): Place {
  const [path = "", search = ""] = window.location.hash.replace(/^#/, "").split("?", 2);
  return { parts: path.split("/").filter(Boolean).map(decoded), query: new URLSearchParams(search) };
}

/** An address cut off in the middle of a sign is no reason to show nothing at all. */
function decoded(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

export const place = new Store<Place>(here());
let shown = window.location.hash;

function arrive(): void {
  shown = window.location.hash;
  place.set(here());
}

export function followAddress(): void {
  window.addEventListener("hashchange", arrive);
}

export function link(parts: string[], query: Record<string, string | null | undefined> = {}): string {
  const search = new URLSearchParams();
  for (const [name, value] of Object.entries(query)) if (value) search.set(name, value);
  const text = search.toString();
  return `#/${parts.map(encodeURIComponent).join("/")}${text ? `?${text}` : ""}`;
}

/** Change some of the query without a new entry in the history. */
export function choose(changes: Record<string, string | null>): void {
  if (window.location.hash !== shown) return; // who has gone on already is not brought back
  const { parts, query } = place.value;
  const next = Object.fromEntries([...query.entries(), ...Object.entries(changes)]);
  window.history.replaceState(null, "", link(parts, next));
  arrive();
}

export function go(parts: string[], query: Record<string, string | null | undefined> = {}): void {
  window.location.hash = link(parts, query);
}
