"""The measurement chain as separate processes, for benchmarks: sources, a router, the service; and what became durable when.

The durable moment of a block of samples is when a second connection to the service's SQLite file first sees it committed.
"""

import contextlib
import sqlite3
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil

from storage.blocks import decode
from tests.end_to_end.processes import Service, example, process, until

POLL_S = 0.005
MACHINE = "thesis-chapter-3"
PLANT = "examples"


@dataclass
class Ledger:
    """When each stored block was first seen, as a reader of the database file sees it."""

    file: Path
    seen: dict[int, int] = field(default_factory=dict)
    _stop: threading.Event = field(default_factory=threading.Event)

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        """Look at the file every POLL_S until the end."""
        thread = threading.Thread(target=self._watch)
        thread.start()
        try:
            yield
        finally:
            self._stop.set()
            thread.join()

    def _watch(self) -> None:
        connection = sqlite3.connect(f"file:{self.file}?mode=ro", uri=True, isolation_level=None)
        newest = 0
        while not self._stop.is_set():
            rows = connection.execute("SELECT id FROM sample_blocks WHERE id > ? ORDER BY id", (newest,)).fetchall()
            moment = time.time_ns()
            for (number,) in rows:
                self.seen[number] = moment
                newest = number
            self._stop.wait(POLL_S)
        connection.close()


@dataclass(frozen=True)
class Journal:
    """What the store holds of each machine: its sequence numbers and times in order, and each sample's latency [s]."""

    numbers: dict[str, np.ndarray]
    times: dict[str, np.ndarray]
    latency: np.ndarray

    @classmethod
    def read(cls, file: Path, ledger: Ledger | None = None) -> "Journal":
        """All of it, from the service's database file."""
        numbers: dict[str, list[np.ndarray]] = {}
        times: dict[str, list[np.ndarray]] = {}
        latency: list[np.ndarray] = []
        with contextlib.closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as connection:
            query = "SELECT id, machine_id, first_sequence, count, data FROM sample_blocks ORDER BY machine_id, first_sequence"
            for number, machine, first, count, data in connection.execute(query):
                held = decode(data)
                assert len(held) == count
                numbers.setdefault(machine, []).append(np.arange(first, first + count))
                times.setdefault(machine, []).append(held.time)
                if ledger is not None:
                    latency.append((ledger.seen[number] - held.time) / 1e9)
        return cls(
            {name: np.concatenate(parts) for name, parts in numbers.items()},
            {name: np.concatenate(parts) for name, parts in times.items()},
            np.concatenate(latency) if latency else np.empty(0),
        )

    def faults(self, machines: list[str], *, samples: int) -> tuple[int, int]:
        """How many of each machine's `samples` are missing, and how many are stored more than once or out of order."""
        lost = twice = 0
        for machine in machines:
            found = self.numbers.get(machine, np.empty(0, int))
            lost += samples - np.unique(found).size
            twice += found.size - np.unique(found).size
            twice += int(np.count_nonzero(np.diff(self.times.get(machine, np.empty(0))) <= 0))
        return lost, twice


def create_machines(service: Service, count: int) -> list[str]:
    """So many machines of 8 channels, alike but for their ids."""
    names = [f"m{number:03d}" for number in range(count)]
    for name in names:
        answer = service.client.post("/machines", json=example(MACHINE) | {"id": name})
        assert answer.status_code == 201, answer.text
    return names


@contextlib.contextmanager
def router(folder: Path, endpoint: str) -> Iterator["subprocess.Popen[bytes]"]:
    """A zenoh router as a process of its own, ready."""
    log = folder / "router.log"
    with process(log, "router", "--listen", endpoint) as started:
        until(lambda: "routing on" in log.read_text(), within_s=20, what="the router listens")
        yield started


@contextlib.contextmanager
def publishing(*arguments: str) -> Iterator["subprocess.Popen[bytes]"]:
    """A benchmark's own publishing process."""
    started = subprocess.Popen([sys.executable, *arguments])
    try:
        yield started
    finally:
        if started.poll() is None:
            started.kill()
        started.wait()


@dataclass
class Usage:
    """Processor time of processes over a stretch, and their largest memory."""

    processes: dict[str, psutil.Process]
    _before: dict[str, float] = field(default_factory=dict)
    _began: float = 0.0

    def begin(self) -> None:
        """From here on."""
        self._before = {name: _processor_s(one) for name, one in self.processes.items()}
        self._began = time.perf_counter()

    def text(self) -> str:
        """Until now, a line a process."""
        elapsed = time.perf_counter() - self._began
        lines = []
        for name, one in self.processes.items():
            busy = 100 * (_processor_s(one) - self._before[name]) / elapsed
            lines.append(f"  {name:8s} {busy:5.0f} % of a core, {one.memory_info().rss / 2**20:5.0f} MiB")
        return "\n".join(lines)


def _processor_s(one: psutil.Process) -> float:
    times = one.cpu_times()
    return float(times.user + times.system)


def patiently(seconds: float) -> bool:
    """Pause, and never give up."""
    time.sleep(seconds)
    return False


def percentiles(seconds: np.ndarray) -> str:
    """p50, p95, p99 and the largest, in words."""
    p50, p95, p99 = np.percentile(seconds, [50, 95, 99])
    return f"p50 {p50:.3f} s   p95 {p95:.3f} s   p99 {p99:.3f} s   max {seconds.max():.3f} s"
