"""The service at half its load for as long as is wanted: whether memory, open files or the write-ahead log grow.

The machines run steadily; with `--starts` they live faster than the clock: they run up and coast down without a pause, in
their own time `--hours-between` from start to start, so that an hour holds many days of runs, identifications, trends, alerts,
and of samples let go of. Meanwhile somebody looks at the pages and at the metrics once a second.

The slope is that of a line through all readings of the second half. A day is `--minutes 1440`; a shorter run says with its
standard error how much of an hour's growth it could see.

    python -m benchmarks.faults.endurance --minutes 60 [--starts] [--rate 2500] [--machines 10]
        [--samples 5000] [--hours-between 4]
"""

import argparse
import contextlib
import itertools
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil
import yaml

from benchmarks.chain import MACHINE, create_machines, measure_in_a_folder, publishing, received
from tests.end_to_end.processes import Service, example, until

ASKED_MB_PER_HOUR = 1.0
EVERY_S = 2.0
WARM_UP = 0.5
"""Part of the time before the slope is taken."""
LONGEST = 3
"""Times as long as asked, at most, where less has happened than is wanted."""
COMPRESSED = {
    "RUNDOWN_RAW_DAYS": "1",
    "RUNDOWN_RUN_DAYS": "2",
    "RUNDOWN_GATHERED_INTERVAL_S": "150",
    "RUNDOWN_BASELINE_RUNS": "5",
}
"""Settings that compress a day's events into an hour."""
LOOKED_AT = (
    "/fleet",
    "/health",
    "/machines/m000",
    "/machines/m000/runs",
    "/machines/m000/identifications",
    "/machines/m000/trends?parameter=coupling.C1.kxx&parameter=bearing.B1.kxx&max_points=500",
    "/machines/m000/alerts",
    "/alerts",
)


@dataclass
class Readings:
    """Readings of the service, one after the other: when [s], memory of its own process and of its workers [MB], open files,
    write-ahead log and database [MB].
    """

    at: list[float] = field(default_factory=list)
    memory: list[float] = field(default_factory=list)
    workers: list[float] = field(default_factory=list)
    files: list[int] = field(default_factory=list)
    log: list[float] = field(default_factory=list)
    database: list[float] = field(default_factory=list)
    lost: int = 0
    happened: dict[str, int] = field(default_factory=dict)

    def read(self, process: psutil.Process, database: Path) -> None:
        """Add one reading."""
        self.at.append(time.monotonic())
        self.memory.append(process.memory_info().rss / 1e6)
        self.workers.append(sum(_memory(child) for child in process.children(recursive=True)) / 1e6)
        self.files.append(process.num_fds())
        self.log.append(_size(Path(f"{database}-wal")))
        self.database.append(_size(database))

    def slope(self) -> tuple[float, float]:
        """Return the slope of the memory after the warm-up, and its standard error [MB/h]."""
        first = round(WARM_UP * len(self.at))
        hours = (np.array(self.at[first:]) - self.at[first]) / 3600.0
        memory = np.array(self.memory[first:])
        (slope, _), covariance = np.polyfit(hours, memory, 1, cov=True)
        return float(slope), float(np.sqrt(covariance[0, 0]))


def _memory(process: psutil.Process) -> int:
    try:
        return int(process.memory_info().rss)
    except psutil.NoSuchProcess:  # a worker that ended just now
        return 0


def _size(file: Path) -> float:
    return file.stat().st_size / 1e6 if file.exists() else 0.0


def measured(folder: Path, options: argparse.Namespace, *, enough: Mapping[str, int] | None = None) -> Readings:
    """Return the readings taken while the service worked.

    enough: counts of `happened` below which it goes on, up to `LONGEST` times as long, as a slow machine needs.
    """
    service = Service(folder, **(COMPRESSED if options.starts else {}))
    readings = Readings()
    with service.running() as serving, living(service, folder, options), looking(service, wanted=options.starts):
        until(lambda: received(service) > 0, within_s=60, what="samples come")
        process, began = psutil.Process(serving.pid), time.monotonic()
        while _goes_on(service, time.monotonic() - began, options, enough or {}):
            readings.read(process, folder / "rundown.db")
            time.sleep(EVERY_S)
        readings.lost = sum(row["lost"] for row in service.get("/sources"))
        readings.happened = happened(service)
    service.client.close()
    return readings


def _goes_on(service: Service, elapsed_s: float, options: argparse.Namespace, enough: Mapping[str, int]) -> bool:
    if elapsed_s < 60 * options.minutes:
        return True
    if elapsed_s > LONGEST * 60 * options.minutes:
        return False
    found = happened(service)
    return any(found[what] < count for what, count in enough.items())


def living(service: Service, folder: Path, options: argparse.Namespace) -> AbstractContextManager[Any]:
    """Return a context in which another process publishes from sources of so many machines."""
    machines = create_machines(service, options.machines)
    if not options.starts:
        arguments = ["-m", "benchmarks.throughput", "--publish", ",".join(machines), "--connect", service.endpoint]
        arguments += ["--folder", str(folder), "--rate", str(options.rate), "--channels", "8"]
        return publishing(*arguments, "--seconds", str(60 * LONGEST * options.minutes + 60))
    files = [folder / f"{machine}.yaml" for machine in machines]
    for file in files:
        file.write_text(yaml.safe_dump(example(MACHINE) | {"id": file.stem}))
    scenarios = [
        f"{file}:{scenario}" for file, scenario in zip(files, itertools.cycle(("healthy", "misalignment", "unbalance")))
    ]
    rate = options.rate / options.machines
    cycles = round((60 * LONGEST * options.minutes + 60) * rate / (2 * options.samples)) + 1
    arguments = ["-m", "service", "simulate", *scenarios, "--connect", service.endpoint, "--cycles", str(cycles)]
    arguments += ["--samples", str(options.samples), "--rate", str(rate)]
    return publishing(*arguments, "--interval-days", str(options.hours_between / 24.0))


@contextlib.contextmanager
def looking(service: Service, *, wanted: bool) -> Iterator[None]:
    """Request what the pages show, and the metrics, once a second until the end of the block, where a refusal is raised."""
    ended = threading.Event()
    refused: list[str] = []

    def look() -> None:
        with httpx.Client(base_url=service.client.base_url, timeout=20.0) as client:
            while not ended.wait(1.0):
                for path in (*LOOKED_AT, f"http://127.0.0.1:{service.port}/metrics"):
                    answer = client.get(path)
                    if answer.status_code != 200:
                        refused.append(f"{answer.status_code} of {path}: {answer.text[:200]}")

    thread = threading.Thread(target=look)
    if wanted:
        thread.start()
    try:
        yield
    finally:
        ended.set()
        if wanted:
            thread.join()
    if refused:
        raise RuntimeError(f"{len(refused)} questions were refused, the first with {refused[0]}")


def happened(service: Service) -> dict[str, int]:
    """Return the number of stored samples, and of runs, identifications and alert events of all machines."""
    machines = service.get("/fleet", since="2000-01-01T00:00:00Z")["machines"]
    events = {kind: sum(one["happened"][kind] for one in machines) for kind in ("runs", "identifications", "alert_events")}
    return {"samples": received(service)} | events


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Print the figures; return whether nothing grows."""
    readings = measured(folder, options)
    half = round(WARM_UP * len(readings.at))
    slope, error = readings.slope()
    how = f"starts {options.hours_between:g} h apart, {options.samples} samples a sweep" if options.starts else "steady"
    print(
        f"{options.minutes:g} minutes at {options.rate:g} samples/s of 8 channels, {how}: "
        f"{readings.happened['samples']} stored, {readings.lost} lost"
    )
    print(
        f"  memory {readings.memory[half]:.0f} MB at half time, {readings.memory[-1]:.0f} MB at the end: "
        f"{slope:+.1f} ± {error:.1f} MB/h; asked: below {ASKED_MB_PER_HOUR:g}"
    )
    print(f"  open files {readings.files[half]} at half time, {readings.files[-1]} at the end; asked: no growth")
    print(f"  write-ahead log at most {max(readings.log):.1f} MB, {readings.log[-1]:.1f} MB at the end")
    print(f"  its workers {readings.workers[half]:.0f} MB at half time, {readings.workers[-1]:.0f} MB at the end")
    print(f"  database {readings.database[half]:.0f} MB at half time, {readings.database[-1]:.0f} MB at the end")
    print("  " + ", ".join(f"{count} {kind.replace('_', ' ')}" for kind, count in readings.happened.items()))
    grows = slope - 2 * error > ASKED_MB_PER_HOUR or max(readings.files[half:]) > max(readings.files[:half])
    return readings.lost == 0 and not grows


def main() -> None:
    """Print the figures; status 1 when something grows."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--starts", action="store_true", help="machines that run up and coast down all the time")
    parser.add_argument("--rate", type=float, default=2500.0, help="samples per second of all machines together")
    parser.add_argument("--machines", type=int, default=10)
    parser.add_argument("--samples", type=int, default=5000, help="of each run-up and run-down")
    parser.add_argument("--hours-between", type=float, default=4.0, help="from start to start, in the machines' time")
    options = parser.parse_args()
    measure_in_a_folder(lambda folder: measure(folder, options))


if __name__ == "__main__":
    main()
