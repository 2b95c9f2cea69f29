"""The service that the browser is shown: a real one that has watched a coupling go out of alignment, and Debian's Chromium."""

import shutil
from datetime import date, datetime, time, timedelta
from pathlib import Path
from zoneinfo import ZoneInfo

from playwright.sync_api import Browser, Playwright

from tests.end_to_end.processes import EXAMPLES, Service, process, until

MACHINE = "thesis-chapter-3"
BASELINE_RUNS = 3
CYCLES = 5
"""So few that the baseline of each kind of run is complete and two more runs agree on an alert."""
ZONE = ZoneInfo("Europe/Berlin")
"""Time zone of the people who look at the page: not UTC, so that a day of theirs is another one for an hour or two."""
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def run_scenario(service: Service) -> None:
    """Some weeks of a machine whose coupling goes out of alignment, all of it identified."""
    service.create(MACHINE)
    simulate(service, MACHINE, cycles=CYCLES, rate=1000, wait_s=90, scenario="misalignment")
    until(service.idle, within_s=90, what="all runs are identified")


def simulate(
    service: Service,
    machine: str,
    *,
    cycles: int,
    rate: float,
    wait_s: float,
    scenario: str = "healthy",
    document: Path | None = None,
) -> None:
    """Run-ups and run-downs over zenoh until all of them are closed. document: by default the example of that name."""
    flags = ["--cycles", str(cycles), "--samples", "60", "--rate", str(rate), "--seed", "3", "--connect", service.endpoint]
    with process(
        service.folder / "simulate.log", "simulate", f"{document or EXAMPLES / f'{machine}.yaml'}:{scenario}", *flags
    ):
        until(lambda: closed(service, machine) == 2 * cycles, within_s=wait_s, what=f"the runs of {machine} are closed")


def closed(service: Service, machine: str) -> int:
    """Return how many runs are closed."""
    return sum(run["state"] == "closed" for run in service.get(f"/machines/{machine}/runs"))


def installed() -> str | None:
    """Debian's Chromium, if it is there."""
    return shutil.which("chromium")


def program_for_tests() -> str | None:
    """Chromium's headless shell, which opens pages with less work, as it draws no windows; else Chromium."""
    return shutil.which("chromium-headless-shell") or installed()


def launch(playwright: Playwright, program: str) -> Browser:
    """A headless browser that speaks to nobody but the pages it is sent to."""
    return playwright.chromium.launch(executable_path=program, args=list(FLAGS))


def day_ahead(days: int) -> date:
    """The day so many days from now, on the calendar beside the page."""
    return datetime.now(ZONE).date() + timedelta(days=days)


def day_of(written: str) -> date:
    """The day there at a time as the API writes it."""
    return datetime.fromisoformat(written).astimezone(ZONE).date()


def end_of(day: date) -> str:
    """The last moment of a day there, for the API."""
    return datetime.combine(day, time.max, ZONE).isoformat()
