"""Takes the picture of the page that the README shows, in a real chromium: the machine of the demo that goes out of alignment.

The demo runs first, some minutes; the picture is committed, so that a reader without it sees the page.

    python -m docs_site.page_picture [FILE]
"""

import argparse
import contextlib
import re
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, ViewportSize, expect, sync_playwright

from tests.browser.shown_service import ZONE, installed, launch

PICTURE = Path(__file__).parents[1] / "docs" / "page.png"
MACHINE = "motor-pump"
SERVING = "Serving until Ctrl-C"
WINDOW = ViewportSize(width=1440, height=1120)
COLOURS = 128
"""Number of colours of the picture, which keeps it small."""
LARGEST_BYTES = 150_000
"""Most that the picture may take."""
SETTLE_MS = 1500


@contextlib.contextmanager
def demonstrated() -> Iterator[str]:
    """Run the demo up to its summary, and yield the address of the page that it serves. Raises SystemExit where it fails."""
    command = [sys.executable, "-m", "service", "demo"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            told = ""
            for line in process.stdout:
                told += line
                if SERVING in line:
                    break
            found = re.search(r"http://127\.0\.0\.1:\d+", told)
            if SERVING not in told or found is None:
                raise SystemExit(f"page_picture: the demo did not come to its end:\n{told}")
            yield found[0]
        finally:
            process.send_signal(signal.SIGINT)


def take(page: Page, base: str, file: Path) -> None:
    """Take the picture of the machine's page."""
    page.goto(f"{base}/#/machines/{MACHINE}")
    expect(page.locator(".element").first).to_be_attached(timeout=30_000)
    expect(page.locator(".loading")).to_have_count(0)
    page.wait_for_timeout(SETTLE_MS)
    with tempfile.TemporaryDirectory() as folder:
        whole = Path(folder) / "page.png"
        page.screenshot(path=whole)
        Image.open(whole).convert("RGB").quantize(COLOURS).save(file, optimize=True)


def main() -> int:
    """Take the picture; status 1 where it is larger than it may be."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, nargs="?", default=PICTURE)
    options = parser.parse_args()
    program = installed()
    if program is None:
        raise SystemExit("page_picture: chromium is not installed: apt-get install chromium")
    with demonstrated() as base, sync_playwright() as playwright:
        browser = launch(playwright, program)
        context = browser.new_context(timezone_id=ZONE.key, locale="en-GB", viewport=WINDOW, color_scheme="light")
        take(context.new_page(), base, options.file)
        browser.close()
    size = options.file.stat().st_size
    print(f"{options.file}: {size / 1000:.0f} kB, {LARGEST_BYTES / 1000:.0f} allowed")
    return 0 if size <= LARGEST_BYTES else 1


if __name__ == "__main__":
    sys.exit(main())
