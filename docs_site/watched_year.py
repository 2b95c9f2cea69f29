"""A running service that has watched the pump over a year of run-downs, for the notebook that asks one.

Service and simulated pump are processes of their own, which work while the other notebooks run.
"""

import contextlib
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from tests.end_to_end.processes import EXAMPLES, Service, process, until

MACHINE = "motor-pump"
SCENARIO = "misalignment"
CYCLES = 8
"""Run-ups and run-downs of the year."""
INTERVAL_DAYS = 45
SAMPLES = 60
"""Samples of each run: the year is identified by the time the other notebooks have run."""
RATE = 300
"""Samples a second that the pump publishes [1/s]."""
WATCHED_S = 240.0
"""Longest time until all runs are identified, on a machine that is busy with other tests [s]."""


@contextlib.contextmanager
def watched_year() -> Iterator[Callable[[], str]]:
    """Start a service and the year of its pump; yields a function that waits until all is identified and returns the URL."""
    with (
        tempfile.TemporaryDirectory(prefix="rundown-year-") as name,
        ThreadPoolExecutor(1) as beside,
        contextlib.ExitStack() as processes,
    ):
        url = beside.submit(_watch, Service(Path(name)), processes)
        try:
            yield url.result
        finally:
            url.exception()  # nothing is ended while it is being started


def _watch(service: Service, processes: contextlib.ExitStack) -> str:
    """Start service and pump, wait until all its runs are identified, and return the URL. processes: ends them."""
    processes.enter_context(service.running())
    service.create(MACHINE)
    scenario = f"{EXAMPLES / MACHINE}.yaml:{SCENARIO}"
    flags = {"cycles": CYCLES, "interval-days": INTERVAL_DAYS, "samples": SAMPLES, "rate": RATE, "connect": service.endpoint}
    options = [str(part) for name, value in flags.items() for part in (f"--{name}", value)]
    processes.enter_context(process(service.folder / "simulate.log", "simulate", scenario, *options))

    def watched() -> bool:
        runs = service.get(f"/machines/{MACHINE}/runs")
        return sum(run["state"] == "closed" for run in runs) == 2 * CYCLES and service.idle()

    until(watched, within_s=WATCHED_S, what="the year's runs are identified")
    return f"http://127.0.0.1:{service.port}"
