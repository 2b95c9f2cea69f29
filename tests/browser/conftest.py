"""A real service with real data, and a real headless Chromium that looks at its page."""

import contextlib
import fcntl
import os
import re
import shutil
import subprocess
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, Playwright, ViewportSize, expect, sync_playwright

from tests.browser.shown_service import BASELINE_RUNS, ZONE, launch, program_for_tests, run_scenario
from tests.end_to_end.processes import ROOT, Service

PICTURES = ROOT / "artefacts" / "browser"
"""Folder in which screenshots are left for people to look at; not committed."""
FAILED = pytest.StashKey[bool]()
"""Of a test that has been run."""
PATIENCE_MS = 20_000
expect.set_options(timeout=PATIENCE_MS)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """A test that fails here is run once more, and pytest names it at the end.

    A browser is a machine of its own that drops an input now and then when the processors are busy; what is wrong in the
    page fails twice. No other tests are run again: there, what fails once is wrong.
    """
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker(pytest.mark.flaky(reruns=1))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Note whether a test failed."""
    report = yield
    if call.when == "call":
        item.stash[FAILED] = report.failed
    return report


class Seen:
    """A page of the dashboard. errors: what the browser complained of."""

    def __init__(self, page: Page, base: str) -> None:
        self.page = page
        self.base = base
        self.errors: list[str] = []
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.on("console", lambda message: self.errors.append(message.text) if message.type == "error" else None)

    def open(self, place: str = "") -> None:
        """Go to a place behind the #."""
        self.page.goto(f"{self.base}/#/{place}")

    def picture(self, name: str) -> None:
        """Leave a screenshot."""
        PICTURES.mkdir(parents=True, exist_ok=True)
        self.page.screenshot(path=PICTURES / f"{name}.png", full_page=True)


@pytest.fixture(scope="session")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The store of a service that has watched a coupling go out of alignment for weeks; one for all processes of tests."""
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "scenario"
    told = folder / "told"
    with locked(folder.with_suffix(".lock")):
        if not told.exists():
            shutil.rmtree(folder, ignore_errors=True)  # of a process that failed
            folder.mkdir()
            one = Service(folder, RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
            with one.running():
                run_scenario(one)
            one.client.close()
            told.touch()
    return folder / "rundown.db"


@contextlib.contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock that no other process of this run of tests has."""
    with path.open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        yield


@pytest.fixture(scope="module")
def place(recorded: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """Yield where a service runs that goes on from there."""
    folder = tmp_path_factory.mktemp("dashboard")
    for file in recorded.parent.glob(f"{recorded.name}*"):  # its log as well, if there is one
        shutil.copy(file, folder)
    one = Service(folder, RUNDOWN_BASELINE_RUNS=str(BASELINE_RUNS))
    yield one
    one.client.close()


@pytest.fixture(scope="module")
def serving(place: Service) -> Iterator[subprocess.Popen[bytes]]:
    """Return the service's process."""
    with place.running() as started:
        yield started


@pytest.fixture
def service(place: Service, serving: subprocess.Popen[bytes]) -> Service:
    """The running service."""
    assert serving.poll() is None
    return place


@pytest.fixture(scope="package")
def driver() -> Iterator[Playwright]:
    """Driver of browsers, one for each process; it ends with this folder, since no other event loop runs beside it."""
    with sync_playwright() as playwright:
        yield playwright


@pytest.fixture(scope="module")
def browser(driver: Playwright) -> Iterator[Browser]:
    """Headless Chromium."""
    program = program_for_tests()
    if program is None:
        if os.environ.get("RUNDOWN_REQUIRE_ALL"):
            pytest.fail("chromium is not installed; .ci/run installs it")
        pytest.skip("chromium is not installed")
    launched = launch(driver, program)
    yield launched
    launched.close()


@pytest.fixture
def seen(browser: Browser, service: Service, request: pytest.FixtureRequest) -> Iterator[Seen]:
    """A fresh page in a window of a laptop; a screenshot is left behind of what a test saw that fails."""
    size = ViewportSize(width=1440, height=900)
    context = browser.new_context(viewport=size, color_scheme="light", timezone_id=ZONE.key, locale="en-GB")
    yield from shown(context, service, request)


@pytest.fixture
def phone(browser: Browser, service: Service, request: pytest.FixtureRequest) -> Iterator[Seen]:
    """The same on a phone: small, and with fingers."""
    size = ViewportSize(width=390, height=844)
    context = browser.new_context(viewport=size, has_touch=True, is_mobile=True, timezone_id=ZONE.key, locale="en-GB")
    yield from shown(context, service, request)


def shown(context: BrowserContext, service: Service, request: pytest.FixtureRequest) -> Iterator[Seen]:
    """A page, while a test looks at it."""
    context.set_default_timeout(PATIENCE_MS)
    one = Seen(context.new_page(), f"http://127.0.0.1:{service.port}")
    yield one
    if request.node.stash.get(FAILED, False):
        one.picture(re.sub(r"\W+", "-", request.node.name.removeprefix("test_")))
    # What the page still asks for meanwhile is nobody's error.
    one.page.unroute_all(behavior="ignoreErrors")
    context.close()
