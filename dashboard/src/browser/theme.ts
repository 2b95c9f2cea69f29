// Light or dark: as the system says, or as a person chose here.
import { Store } from "./store";

export type Choice = "system" | "light" | "dark";

const KEY = "rundown.theme";
const dark = window.matchMedia("(prefers-color-scheme: dark)");

function chosen(): Choice {
  const kept = window.localStorage.getItem(KEY);
  return kept === "light" || kept === "dark" ? kept : "system";
}

export const choice = new Store<Choice>(chosen());
/** What is shown now; plots are drawn again when it changes. */
export const shown = new Store<"light" | "dark">("light");

let paper = false;

/** Paper is light, whatever the screen is: a report looks as it will be printed. */
export function onPaper(is: boolean): void {
  paper = is;
  apply();
}

function apply(): void {
  const now = paper ? "light" : choice.value === "system" ? (dark.matches ? "dark" : "light") : choice.value;
  document.documentElement.dataset.theme = now;
  shown.set(now);
}

export function choose(next: Choice): void {
  window.localStorage.setItem(KEY, next);
  choice.set(next);
  apply();
}

export function followSystem(): void {
  dark.addEventListener("change", apply);
  apply();
}

/** A colour of the style sheet, for canvases. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
