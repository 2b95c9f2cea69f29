"""Takes a picture of every view, by day, by night, in German and on a phone, and compares it with the last accepted one.

Two pictures are the same where only a small part of their blocks differs clearly: times and noise differ in every
run. So of an accepted picture the mean brightness of each block is kept, as a PNG of some kB that is committed; `--accept`
makes the new ones the accepted ones, `--taken` takes none anew. Other fonts or another browser than those of the accepted ones
look otherwise: `--accepted` names a folder of one's own.

    python -m benchmarks.page_screens [--folder artefacts/screens] [--accepted FOLDER] [--accept] [--taken]
"""

import argparse
import tempfile
from collections.abc import Collection
from pathlib import Path

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, ViewportSize, expect, sync_playwright

from estimator.arrays import Floats
from tests.browser.levels import COPY, FILMS, add_copy, add_films
from tests.browser.shown_service import BASELINE_RUNS, ZONE, installed, launch, run_scenario
from tests.browser.views import VIEWS, show
from tests.end_to_end.processes import Service

BLOCK_PX = 16
"""Side of a block: what changes within one, as a digit does, hardly changes its mean."""
CLEARLY = 24.0
"""Difference of a block's mean brightness that a person sees [of 255]."""
MOST_BLOCKS = 0.02
"""Part of the blocks that may differ clearly [-]."""
SETTLE_MS = 500
PATIENCE_MS = 120_000
"""Longest time until a view is whole: models of trains on films are computed meanwhile."""
ACCEPTED = Path(__file__).with_name("accepted_screens")
OTHERS = {
    "levels": (f"machines/{COPY}/vibration", ".polar svg"),
    "levels-overview": (f"machines/{COPY}", ".gap-of"),
    "films": (f"machines/{FILMS}/model", ".films svg"),
}
"""Views of machines that send more, or stand on oil films."""
IN_MILS = ("alert", "overview", "vibration", "response", "films", "levels", "report")
"""Views that are taken in other units as well."""
MILS = 'window.localStorage.setItem("rundown.units", "mil_p,hz");'
SIZES: dict[str, dict[str, object]] = {
    "light": {"viewport": ViewportSize(width=1440, height=900), "color_scheme": "light"},
    "dark": {"viewport": ViewportSize(width=1440, height=900), "color_scheme": "dark"},
    "german": {"viewport": ViewportSize(width=1440, height=900), "color_scheme": "light", "locale": "de-DE"},
    "phone": {"viewport": ViewportSize(width=390, height=844), "has_touch": True, "is_mobile": True},
    "mil": {"viewport": ViewportSize(width=1440, height=900), "color_scheme": "light"},
}


def views_in(size: str) -> Collection[str]:
    """Return the views that are taken in a size."""
    return IN_MILS if size == "mil" else VIEWS | OTHERS


def take(browser: Browser, base: str, folder: Path) -> list[Path]:
    """Take all pictures."""
    expect.set_options(timeout=PATIENCE_MS)
    taken = []
    for size, options in SIZES.items():
        context = browser.new_context(**{"timezone_id": ZONE.key, "locale": "en-GB"} | options)  # type: ignore[arg-type]
        page = context.new_page()
        if size == "mil":
            page.add_init_script(MILS)
        for view in views_in(size):
            show(page, base, view, views=VIEWS | OTHERS)
            expect(page.locator(".error")).to_have_count(0)
            page.wait_for_timeout(SETTLE_MS)
            taken.append(folder / f"{size}-{view}.png")
            page.screenshot(path=taken[-1], full_page=True)
        context.close()
    return taken


def difference(picture: Path, accepted: Path) -> float:
    """Return the part of a picture's blocks that differs clearly; where it is not as high as the accepted one, all below."""
    first, second = blocks(picture), np.asarray(Image.open(accepted), dtype=float)
    rows, columns = max(len(first), len(second)), max(first.shape[1], second.shape[1])
    common = min(len(first), len(second)), min(first.shape[1], second.shape[1])
    apart = np.abs(first[: common[0], : common[1]] - second[: common[0], : common[1]]) > CLEARLY
    alike = common[0] * common[1] - int(np.count_nonzero(apart))
    return float(1.0 - alike / (rows * columns))


def blocks(path: Path) -> Floats:
    """Return the mean brightness of each block of a picture."""
    grey = np.asarray(Image.open(path).convert("L"), dtype=float)
    rows, columns = (size // BLOCK_PX for size in grey.shape)
    cut = grey[: rows * BLOCK_PX, : columns * BLOCK_PX].reshape(rows, BLOCK_PX, columns, BLOCK_PX)
    return np.asarray(cut.mean(axis=(1, 3)))


def compare(taken: list[Path], accepted: Path, *, accept: bool) -> int:
    """Print what differs, accept it where asked, and return how many pictures differ or are new."""
    accepted.mkdir(parents=True, exist_ok=True)
    changed = 0
    for path in taken:
        known = accepted / path.name
        part = difference(path, known) if known.exists() else None
        if part is None or part > MOST_BLOCKS:
            changed += 1
            print(f"  {path.name:<28} {'new' if part is None else f'{100 * part:.1f} % differs'}")
        if accept:
            Image.fromarray(np.round(blocks(path)).astype(np.uint8)).save(known, optimize=True)
    print(f"{len(taken)} pictures, {changed} differ from the accepted ones{'; all are accepted now' if accept else ''}")
    return 0 if accept else changed


def main(arguments: list[str] | None = None) -> None:
    """Take and compare; end with status 1 where a picture differs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("artefacts/screens"))
    parser.add_argument("--accepted", type=Path, default=ACCEPTED, help="folder of the accepted pictures")
    parser.add_argument("--accept", action="store_true")
    parser.add_argument("--taken", action="store_true", help="compare or accept the pictures that were taken last")
    options = parser.parse_args(arguments)
    new = options.folder / "new"
    taken = sorted(new.glob("*.png")) if options.taken else take_all(new)
    if not taken:
        raise SystemExit(f"page_screens: {new} holds no picture: take them first, without --taken")
    if compare(taken, options.accepted, accept=options.accept):
        raise SystemExit(1)


def take_all(new: Path) -> list[Path]:
    """Run the scenario, and take a picture of each view into a folder."""
    program = installed()
    if program is None:
        raise SystemExit("page_screens: chromium is not installed: apt-get install chromium")
    new.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        service = Service(Path(folder), RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
        with service.running(), sync_playwright() as playwright:
            run_scenario(service)
            add_copy(service)
            add_films(service)
            browser = launch(playwright, program)
            taken = take(browser, f"http://127.0.0.1:{service.port}", new)
            browser.close()
        service.client.close()
    return taken


if __name__ == "__main__":
    main()
