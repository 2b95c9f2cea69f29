// Choose the language of the page, which is then loaded anew.
import { chooseLocale, locale, LOCALES } from "../messages/locale";
import { t } from "../messages/messages";

export function LanguageSelect() {
  return (
    <select class="units" aria-label={t("thisLanguage")} value={locale} onChange={(event) => chooseLocale(event.currentTarget.value)}>
      {Object.entries(LOCALES).map(([name, own]) => (
        <option key={name} value={name} lang={name}>
          {own}
        </option>
      ))}
    </select>
  );
}
