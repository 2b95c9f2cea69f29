// Keyboard shortcuts, and the list of them.
import { useLayoutEffect } from "preact/hooks";
import { navigate, route } from "../browser/router";
import { chooseTheme, themeChoice } from "../browser/theme";
import { Dialog } from "../dialogs/dialog";
import { t } from "../messages/messages";
import { TABS } from "../pages/tabs";

const SHORTCUTS: [string, string][] = [
  ["f", t("shortcutFleet")],
  ["a", t("shortcutAlerts")],
  ["w", t("shortcutNotifications")],
  ["1 … 9", t("tabsOfAMachine")],
  ["d", t("darkOrLight")],
  [t("inAPlot"), t("moveTheReadOutWith")],
  [t("enterInATrend"), t("openTheIdentificationOfThe")],
  [t("inAPolarPlot"), t("readOutAnotherCurve")],
  [t("inAMatrix"), t("moveTheReadOut")],
  [t("n0InAPlot"), t("zoomInOutBackTo")],
  [t("esc"), t("shortcutClose")],
  ["?", t("thisList")],
];

export function useShortcuts(toggleList: () => void): void {
  useLayoutEffect(() => {
    const onKey = (event: KeyboardEvent) => {
      // A window that was just closed keeps the focus until the browser draws again.
      const target = event.target as HTMLElement;
      if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea, dialog[open]")) return;
      if (event.key === "?") toggleList();
      else follow(event.key);
    };
    window.addEventListener("keydown", onKey);
    return () => window.removeEventListener("keydown", onKey);
  }, [toggleList]);
}

function follow(key: string): void {
  const tab = TABS[Number(key) - 1];
  const { parts } = route.value;
  if (key === "f") navigate([]);
  else if (key === "a") navigate(["alerts"]);
  else if (key === "w") navigate(["subscriptions"]);
  else if (key === "d") chooseTheme(themeChoice.value === "dark" ? "light" : "dark");
  else if (tab && parts[0] === "machines" && parts[1]) navigate(["machines", parts[1], tab.id]);
}

export function KeyboardShortcuts({ onClose }: { onClose: () => void }) {
  return (
    <Dialog title={t("keyboardShortcuts")} onClose={onClose}>
      <dl class="facts">
        {SHORTCUTS.map(([key, action]) => (
          <>
            <dt>
              <kbd>{key}</kbd>
            </dt>
            <dd>{action}</dd>
          </>
        ))}
      </dl>
      <p>
        <button type="button" onClick={onClose}>
          {t("closeWindow")}
        </button>
      </p>
    </Dialog>
  );
}
