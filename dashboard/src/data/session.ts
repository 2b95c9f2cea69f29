// Who is logged in. Where the service asks nobody who they are, nobody is.
import { Store } from "../browser/store";

export interface Me {
  name: string;
  role: string;
  plants: string[] | null;
  kind: "open" | "key" | "token" | "session";
  /** What each change must bring along. */
  token: string | null;
}

const LOGIN = "/login";
const AFTER = "rundown.after-login";

let leaving = false;

export const me = new Store<Me | null>(null);

/** The service wants to know who this is: remember the place, and go and log in. */
export function refused(): void {
  if (!leaving) window.sessionStorage.setItem(AFTER, window.location.hash);
  leave();
}

/** Once: every question that is open is refused, and a second departure would break off the first. */
function leave(): void {
  if (leaving) return;
  leaving = true;
  window.location.assign(LOGIN);
}

export function changeHeaders(): Record<string, string> {
  const token = me.value?.token;
  return token ? { "x-rundown-token": token } : {};
}

export async function findOut(): Promise<void> {
  try {
    const response = await fetch("/api/v1/me", { headers: { accept: "application/json" }, cache: "no-store" });
    if (response.status === 401) refused();
    if (!response.ok) return;
    me.set((await response.json()) as Me);
  } catch {
    return; // whoever shows something finds out that nobody answers
  }
  const place = window.sessionStorage.getItem(AFTER);
  window.sessionStorage.removeItem(AFTER);
  if (place && !window.location.hash) window.location.hash = place;
}

export async function logOut(): Promise<void> {
  await fetch("/logout", { method: "POST", headers: changeHeaders() });
  leave();
}
