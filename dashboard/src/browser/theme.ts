// The colour theme: that of the system, or one chosen here.
import { Store } from "./store";

export type ThemeChoice = "system" | "light" | "dark";

const STORAGE_KEY = "rundown.theme";
const dark = window.matchMedia("(prefers-color-scheme: dark)");

function savedChoice(): ThemeChoice {
  const saved = window.localStorage.getItem(STORAGE_KEY);
  return saved === "light" || saved === "dark" ? saved : "system";
}

export const themeChoice = new Store<ThemeChoice>(savedChoice());
/** The theme shown now; plots are drawn again when it changes. */
export const activeTheme = new Store<"light" | "dark">("light");

let printing = false;

/** Use the light theme, whatever the screen has: a report looks as it will be printed. */
export function setPrintColours(on: boolean): void {
  printing = on;
  apply();
}

function apply(): void {
  const choice = themeChoice.value;
  const theme = printing ? "light" : choice === "system" ? (dark.matches ? "dark" : "light") : choice;
  document.documentElement.dataset.theme = theme;
  activeTheme.set(theme);
}

export function chooseTheme(next: ThemeChoice): void {
  window.localStorage.setItem(STORAGE_KEY, next);
  themeChoice.set(next);
  apply();
}

export function startTheme(): void {
  dark.addEventListener("change", apply);
  apply();
}

/** A colour of the style sheet, for canvases. */
export function cssColour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}
