// The language of the page: the one chosen here and kept by the browser, else the first of the browser's that there is.

const STORAGE_KEY = "rundown.locale";

/** Each language by its own name. */
export const LOCALES = { en: "English", de: "Deutsch" } as const;

export type Locale = keyof typeof LOCALES;

function known(name: string | null): Locale | undefined {
  const language = name?.toLowerCase().split("-")[0];
  return (Object.keys(LOCALES) as Locale[]).find((one) => one === language);
}

/** The language that was chosen here; undefined where nobody has chosen. */
export const chosenLocale: Locale | undefined = known(window.localStorage.getItem(STORAGE_KEY));

function wanted(): Locale {
  const ofBrowser = navigator.languages.map(known).find((one) => one !== undefined);
  return chosenLocale ?? ofBrowser ?? "en";
}

/** It stays as long as the page: another one is chosen by loading it anew. */
export const locale: Locale = wanted();

export function chooseLocale(name: string): void {
  window.localStorage.setItem(STORAGE_KEY, known(name) ?? "en");
  window.location.reload();
}
