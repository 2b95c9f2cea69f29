// What can be done with keys alone.
import { useLayoutEffect } from "preact/hooks";
import { Dialog } from "../dialogs/dialog";
import { go, place } from "../browser/router";
import { TABS } from "../pages/tabs";
import { choice, choose } from "../browser/theme";

const SAID: [string, string][] = [
  ["f", "fleet"],
  ["a", "alerts"],
  ["w", "who is told"],
  ["1 … 7", "tabs of a machine"],
  ["d", "dark or light"],
  ["← → in a plot", "move the read-out; with Shift ten points"],
  ["Enter in a trend", "open the identification of the point read out"],
  ["↑ ↓ in a polar plot", "read out another curve"],
  ["← → ↑ ↓ in a matrix", "move the read-out"],
  ["+ − 0 in a plot", "zoom in, out, back to all"],
  ["Esc", "close"],
  ["?", "this list"],
];

export function useShortcuts(toggleKeys: () => void): void {
  useLayoutEffect(() => {
    const pressed = (event: KeyboardEvent) => {
      // A window that was just closed has the focus until the browser draws again.
      const target = event.target as HTMLElement;
      if (event.ctrlKey || event.metaKey || event.altKey || target.closest("input, select, textarea, dialog[open]")) return;
      const tab = TABS[Number(event.key) - 1];
      const { parts } = place.value;
      if (event.key === "?") toggleKeys();
      else if (event.key === "f") go([]);
      else if (event.key === "a") go(["alerts"]);
      else if (event.key === "w") go(["subscriptions"]);
      else if (event.key === "d") choose(choice.value === "dark" ? "light" : "dark");
      else if (tab && parts[0] === "machines" && parts[1]) go(["machines", parts[1], tab.id]);
    };
    window.addEventListener("keydown", pressed);
    return () => window.removeEventListener("keydown", pressed);
  }, [toggleKeys]);
}

export function Keys({ onClose }: { onClose: () => void }) {
  return (
    <Dialog title="Keys" onClose={onClose}>
      <dl class="facts">
        {SAID.map(([key, does]) => (
          <>
            <dt>
              <kbd>{key}</kbd>
            </dt>
            <dd>{does}</dd>
          </>
        ))}
      </dl>
      <p>
        <button type="button" onClick={onClose}>
          Close
        </button>
      </p>
    </Dialog>
  );
}
