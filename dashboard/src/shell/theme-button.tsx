// Choose the colours: those of the system, light, dark.
import { useStore } from "../browser/store";
import { chooseTheme, themeChoice, type ThemeChoice } from "../browser/theme";
import { t, term } from "../messages/messages";

const NEXT: Record<ThemeChoice, ThemeChoice> = { system: "light", light: "dark", dark: "system" };
const SIGNS: Record<ThemeChoice, string> = { system: "◐", light: "☼", dark: "☾" };

export function ThemeButton() {
  const now = useStore(themeChoice);
  return (
    <button
      type="button"
      class="quiet theme"
      onClick={() => chooseTheme(NEXT[now])}
      aria-label={t("coloursNow", { now: term(now), next: term(NEXT[now]) })}
      title={t("coloursKey", { now: term(now) })}
    >
      {SIGNS[now]}
    </button>
  );
}
