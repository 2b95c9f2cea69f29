"""Time until a machine's page shows something, with an empty cache, and the bytes that takes.

A real service with real runs and a real headless Chromium on loopback. *First contentful paint* and *largest contentful paint*
are the browser's own; *meaningful* is the frame after the one in which the machine's name, its train and its alerts are there.

    python -m benchmarks.page_paint [--runs 15]
"""

import argparse
import json
import statistics
import tempfile
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, sync_playwright

from tests.browser.shown_service import BASELINE_RUNS, MACHINE, installed, launch, run_scenario
from tests.end_to_end.processes import Service, until

PAINT_ASKED_S = 0.6
BYTES_ASKED = 150_000
SETTLE_MS = 700
"""Time after the first paint in which further requests are still counted."""

WATCH = """
window.painted = {};
new PerformanceObserver((list) => {
  for (const one of list.getEntries()) window.painted.largest = one.startTime;
}).observe({ type: "largest-contentful-paint", buffered: true });
const look = () => {
  const whole = ["h1", ".train .element", ".alert-row, .alerts, .panel .empty"].every((one) => document.querySelector(one));
  if (!whole) return requestAnimationFrame(look);
  requestAnimationFrame(() => { window.painted.meaningful = performance.now(); });
};
requestAnimationFrame(look);
"""


def measure(browser: Browser, address: str) -> dict[str, float]:
    """Return times [s] and bytes of one visit with an empty cache."""
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = context.new_page()
    page.add_init_script(WATCH)
    wire = context.new_cdp_session(page)
    wire.send("Network.enable")
    sent: list[float] = []
    wire.on("Network.loadingFinished", lambda event: sent.append(event["encodedDataLength"]))
    page.goto(address)
    until(lambda: page.evaluate("window.painted.meaningful !== undefined"), within_s=30, what="the page is drawn")
    page.wait_for_timeout(SETTLE_MS)
    first = "performance.getEntriesByName('first-contentful-paint')[0].startTime"
    found: dict[str, Any] = json.loads(page.evaluate(f"JSON.stringify({{...window.painted, first: {first}}})"))
    context.close()
    return {name: value / 1000.0 for name, value in found.items()} | {"bytes": sum(sent)}


def main(arguments: list[str] | None = None) -> None:
    """Print the figures beside those asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=15)
    options = parser.parse_args(arguments)
    program = installed()
    if program is None:
        print("page_paint: chromium is not installed: apt-get install chromium")
        return
    with tempfile.TemporaryDirectory() as folder:
        service = Service(Path(folder), RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
        with service.running(), sync_playwright() as playwright:
            run_scenario(service)
            browser = launch(playwright, program)
            visits = [measure(browser, f"http://127.0.0.1:{service.port}/#/machines/{MACHINE}") for _ in range(options.runs)]
            browser.close()
        service.client.close()
    _print(visits)


def _print(visits: list[dict[str, float]]) -> None:
    def figures(name: str) -> tuple[float, float]:
        values = [visit[name] for visit in visits]
        return statistics.median(values), max(values)

    print(f"A machine's page on loopback, empty cache, {len(visits)} visits: median, worst")
    for name, words in (("first", "first contentful paint"), ("meaningful", "first meaningful paint"), ("largest", "largest")):
        median, worst = figures(name)
        asked = f", asked at most {PAINT_ASKED_S} s" if name == "meaningful" else ""
        print(f"  {words:<24} {median:6.2f} s {worst:6.2f} s{asked}")
    median, worst = figures("bytes")
    print(f"  {'transferred':<24} {median / 1000:6.0f} kB {worst / 1000:5.0f} kB, asked at most {BYTES_ASKED / 1000:.0f} kB")


if __name__ == "__main__":
    main()
