// The name under which changes are made: of the user who is logged in, else the one entered last.
import { currentUser } from "./session";

const STORAGE_KEY = "rundown.name";

export function savedAuthorName(): string {
  if (currentUser.value?.kind === "session") return currentUser.value.name;
  return window.localStorage.getItem(STORAGE_KEY) ?? "";
}

export function saveAuthorName(name: string): void {
  window.localStorage.setItem(STORAGE_KEY, name);
}
