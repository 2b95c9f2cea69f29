// The user who is logged in; nobody where the service asks for no login.
import { Store, useStore } from "../browser/store";
import { chosenLocale } from "../messages/locale";

export interface CurrentUser {
  name: string;
  role: string;
  plants: string[] | null;
  kind: "open" | "key" | "token" | "session";
  /** CSRF token that each change must carry. */
  token: string | null;
}

/** Roles in ascending order; each includes the rights of those before it. */
const ROLES = ["source", "viewer", "analyst", "operator", "admin"];

const LOGIN = "/login";
const RETURN_TO = "rundown.after-login";

let leaving = false;

export const currentUser = new Store<CurrentUser | null>(null);

/** Whether the user has a role, or one above it; false while that is not known. */
export function useMay(role: "analyst"): boolean {
  const user = useStore(currentUser);
  return user !== null && ROLES.indexOf(user.role) >= ROLES.indexOf(role);
}

/** Remember the address, and go to the login page. */
export function redirectToLogin(): void {
  if (!leaving) window.sessionStorage.setItem(RETURN_TO, window.location.hash);
  leave();
}

/** Leave once: every request under way is refused, and a second navigation would cancel the first. */
function leave(): void {
  if (leaving) return;
  leaving = true;
  window.location.assign(chosenLocale ? `${LOGIN}?locale=${chosenLocale}` : LOGIN);
}

export function csrfHeaders(): Record<string, string> {
  const token = currentUser.value?.token;
  return token ? { "x-rundown-token": token } : {};
}

export async function loadCurrentUser(): Promise<void> {
  try {
    const response = await fetch("/api/v1/me", { headers: { accept: "application/json" }, cache: "no-store" });
    if (response.status === 401) redirectToLogin();
    if (!response.ok) return;
    currentUser.set((await response.json()) as CurrentUser);
  } catch {
    return; // the connection's heartbeat reports that the service does not answer
  }
  const hash = window.sessionStorage.getItem(RETURN_TO);
  window.sessionStorage.removeItem(RETURN_TO);
  if (hash && !window.location.hash) window.location.hash = hash;
}

export async function logOut(): Promise<void> {
  await fetch("/logout", { method: "POST", headers: csrfHeaders() });
  leave();
}
