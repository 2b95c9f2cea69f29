"""The service at half its load for as long as is wanted: whether memory, open files or the write-ahead log grow.

The slope is that of a line through all readings of the second half. A day is `--minutes 1440`; a shorter run says with its
standard error how much of an hour's growth it could see.

    python -m benchmarks.endurance --minutes 60 [--rate 2500] [--machines 10]
"""

import argparse
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil

from benchmarks.chain import create_machines, publishing
from tests.end_to_end.processes import Service, until

ASKED_MB_PER_HOUR = 1.0
EVERY_S = 2.0
WARM_UP = 0.5
"""Part of the time before the slope is taken."""


@dataclass
class Readings:
    """Of the service, one after the other: when [s], memory of its own process [MB], open files, write-ahead log [MB]."""

    at: list[float] = field(default_factory=list)
    memory: list[float] = field(default_factory=list)
    files: list[int] = field(default_factory=list)
    log: list[float] = field(default_factory=list)
    stored: int = 0
    lost: int = 0

    def read(self, process: psutil.Process, database: Path) -> None:
        """One more."""
        log = Path(f"{database}-wal")
        self.at.append(time.monotonic())
        self.memory.append(process.memory_info().rss / 1e6)
        self.files.append(process.num_fds())
        self.log.append(log.stat().st_size / 1e6 if log.exists() else 0.0)

    def slope(self) -> tuple[float, float]:
        """Of the memory after the warm-up, and its standard error [MB/h]."""
        first = round(WARM_UP * len(self.at))
        hours = (np.array(self.at[first:]) - self.at[first]) / 3600.0
        memory = np.array(self.memory[first:])
        (slope, _), covariance = np.polyfit(hours, memory, 1, cov=True)
        return float(slope), float(np.sqrt(covariance[0, 0]))


def measured(folder: Path, options: argparse.Namespace) -> Readings:
    """What was read while the service worked."""
    service = Service(folder)
    readings = Readings()
    with service.running() as serving:
        machines = create_machines(service, options.machines)
        arguments = ["-m", "benchmarks.throughput", "--publish", ",".join(machines), "--connect", service.endpoint]
        arguments += ["--folder", str(folder), "--rate", str(options.rate), "--channels", "8"]
        arguments += ["--seconds", str(60 * options.minutes + 60)]
        with publishing(*arguments):
            until(lambda: received(service) > 0, within_s=60, what="samples come")
            process, began = psutil.Process(serving.pid), time.monotonic()
            while time.monotonic() - began < 60 * options.minutes:
                readings.read(process, folder / "rundown.db")
                time.sleep(EVERY_S)
            readings.stored = received(service)
            readings.lost = sum(row["lost"] for row in service.get("/sources"))
    service.client.close()
    return readings


def measure(folder: Path, options: argparse.Namespace) -> bool:
    """Print the figures; whether nothing grows."""
    readings = measured(folder, options)
    half = round(WARM_UP * len(readings.at))
    slope, error = readings.slope()
    print(
        f"{options.minutes:g} minutes at {options.rate:g} samples/s of 8 channels: "
        f"{readings.stored} stored, {readings.lost} lost"
    )
    print(
        f"  memory {readings.memory[half]:.0f} MB at half time, {readings.memory[-1]:.0f} MB at the end: "
        f"{slope:+.1f} ± {error:.1f} MB/h; asked: below {ASKED_MB_PER_HOUR:g}"
    )
    print(f"  open files {readings.files[half]} at half time, {readings.files[-1]} at the end; asked: no growth")
    print(f"  write-ahead log at most {max(readings.log):.1f} MB, {readings.log[-1]:.1f} MB at the end")
    grows = slope - 2 * error > ASKED_MB_PER_HOUR or max(readings.files[half:]) > max(readings.files[:half])
    return readings.lost == 0 and not grows


def received(service: Service) -> int:
    """Samples that the service has stored."""
    return sum(source["received"] for source in service.get("/sources"))


def main() -> None:
    """Print the figures; status 1 when something grows."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=2500.0, help="samples per second of all machines together")
    parser.add_argument("--machines", type=int, default=10)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if not measure(Path(folder), options):
            raise SystemExit(1)


if __name__ == "__main__":
    main()
