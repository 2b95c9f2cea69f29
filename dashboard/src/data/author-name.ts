// Who sits here: who is logged in, else what they said last.
import { me } from "./session";

const KEY = "rundown.name";

export function keptName(): string {
  if (me.value?.kind === "session") return me.value.name;
  return window.localStorage.getItem(KEY) ?? "";
}

export function keepName(name: string): void {
  window.localStorage.setItem(KEY, name);
}
