// Who sits here, as they said last.

const KEY = "rundown.name";

export function keptName(): string {
  return window.localStorage.getItem(KEY) ?? "";
}

export function keepName(name: string): void {
  window.localStorage.setItem(KEY, name);
}
