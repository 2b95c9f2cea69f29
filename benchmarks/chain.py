"""The measurement chain as separate processes, for benchmarks: sources, a router, the service; and what became durable when.

The durable moment of a block is when a connection of this process to the service's database first sees it committed.
"""

import argparse
import contextlib
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import psutil
from sqlalchemy import bindparam, select

from storage.database.engine import engine_of
from storage.encoding.sample_blocks import decode
from storage.tables.measurements import SampleBlockRow
from tests.end_to_end.processes import Service, example, process, until

POLL_S = 0.005
MACHINE = "thesis-chapter-3"
PLANT = "examples"


@dataclass
class Ledger:
    """Times at which each stored block was first seen, as another reader of the database sees it."""

    database: str
    seen: dict[int, int] = field(default_factory=dict)
    _stop: threading.Event = field(default_factory=threading.Event)

    @contextlib.contextmanager
    def watching(self) -> Iterator[None]:
        """Look into it every POLL_S until the end."""
        thread = threading.Thread(target=self._watch)
        thread.start()
        try:
            yield
        finally:
            self._stop.set()
            thread.join()

    def _watch(self) -> None:
        engine = engine_of(self.database)
        newest = 0
        query = select(SampleBlockRow.id).where(SampleBlockRow.id > bindparam("newest")).order_by(SampleBlockRow.id)
        with engine.connect() as connection:
            while not self._stop.is_set():
                numbers = connection.scalars(query, {"newest": newest}).all()
                moment = time.time_ns()
                connection.rollback()  # the next look sees what is committed then
                for number in numbers:
                    self.seen[number] = moment
                    newest = number
                self._stop.wait(POLL_S)
        engine.dispose()


@dataclass(frozen=True)
class StoredSamples:
    """The stored samples of each machine: their sequence numbers and times in order, and each sample's latency [s]."""

    numbers: dict[str, np.ndarray]
    times: dict[str, np.ndarray]
    latency: np.ndarray

    @classmethod
    def read(cls, database: str, ledger: Ledger | None = None) -> "StoredSamples":
        """Read all samples from the service's database."""
        numbers: dict[str, list[np.ndarray]] = {}
        times: dict[str, list[np.ndarray]] = {}
        latency: list[np.ndarray] = []
        row = SampleBlockRow
        query = select(row.id, row.machine_id, row.first_sequence, row.count, row.data)
        query = query.order_by(row.machine_id, row.first_sequence)
        engine = engine_of(database)
        with engine.connect() as connection:
            for number, machine, first, count, data in connection.execute(query):
                held = decode(data)
                assert len(held) == count
                numbers.setdefault(machine, []).append(np.arange(first, first + count))
                times.setdefault(machine, []).append(held.time)
                if ledger is not None:
                    latency.append((ledger.seen[number] - held.time) / 1e9)
        engine.dispose()
        return cls(
            {name: np.concatenate(parts) for name, parts in numbers.items()},
            {name: np.concatenate(parts) for name, parts in times.items()},
            np.concatenate(latency) if latency else np.empty(0),
        )

    def faults(self, machines: list[str], *, samples: int) -> tuple[int, int]:
        """Return how many of each machine's `samples` are missing, and how many are stored more than once or out of order."""
        lost = twice = 0
        for machine in machines:
            found = self.numbers.get(machine, np.empty(0, int))
            lost += samples - np.unique(found).size
            twice += found.size - np.unique(found).size
            twice += int(np.count_nonzero(np.diff(self.times.get(machine, np.empty(0))) <= 0))
        return lost, twice


def create_machines(service: Service, count: int, *, channels: int = 8) -> list[str]:
    """Create machines of 8 or 16 channels, alike except for their ids; return the ids."""
    names = [f"m{number:03d}" for number in range(count)]
    document = example(MACHINE)
    turned = [probe | {"id": further(probe["id"]), "angle_deg": probe["angle_deg"] + 45} for probe in document["probes"]]
    document["probes"] = [*document["probes"], *turned][:channels]
    for name in names:
        answer = service.client.post("/machines", json=document | {"id": name})
        assert answer.status_code == 201, answer.text
    return names


def received(service: Service) -> int:
    """Return the number of samples that the service has stored."""
    return sum(source["received"] for source in service.get("/sources", limit=1000))


def further(channel: str) -> str:
    """Return the second probe beside one of the example's."""
    return f"{channel}2"


@contextlib.contextmanager
def router(folder: Path, endpoint: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Yield a zenoh router in a process of its own, once it is ready."""
    log = folder / "router.log"
    with process(log, "router", "--listen", endpoint) as started:
        until(lambda: "routing on" in log.read_text(), within_s=20, what="the router listens")
        yield started


@contextlib.contextmanager
def publishing(*arguments: str) -> Iterator["subprocess.Popen[bytes]"]:
    """Yield a benchmark's own publishing process."""
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
        """Begin the measurement."""
        self._before = {name: processor_s(one) for name, one in self.processes.items()}
        self._began = time.perf_counter()

    def text(self) -> str:
        """Return the usage until now, a line per process."""
        elapsed = time.perf_counter() - self._began
        lines = []
        for name, one in self.processes.items():
            busy = 100 * (processor_s(one) - self._before[name]) / elapsed
            lines.append(f"  {name:8s} {busy:5.0f} % of a core, {one.memory_info().rss / 2**20:5.0f} MiB")
        return "\n".join(lines)


def processor_s(one: psutil.Process) -> float:
    """Return the processor time that a process has used [s]."""
    times = one.cpu_times()
    return float(times.user + times.system)


def publish_or_measure(
    options: argparse.Namespace,
    publish: Callable[[argparse.Namespace], None],
    measure: Callable[[Path, argparse.Namespace], bool],
) -> None:
    """Publish where `--publish` asks this process to, else measure; status 1 when a figure is not as asked."""
    if options.publish:
        publish(options)
    else:
        measure_in_a_folder(lambda folder: measure(folder, options))


def measure_in_a_folder(measure: Callable[[Path], bool]) -> None:
    """Measure in a folder that is gone afterwards; status 1 when a figure is not as asked."""
    with tempfile.TemporaryDirectory() as folder:
        if not measure(Path(folder)):
            raise SystemExit(1)


def patiently(seconds: float) -> bool:
    """Pause, and never give up."""
    time.sleep(seconds)
    return False


def percentiles(seconds: np.ndarray) -> str:
    """Return p50, p95, p99 and the largest value as text."""
    p50, p95, p99 = np.percentile(seconds, [50, 95, 99])
    return f"p50 {p50:.3f} s   p95 {p95:.3f} s   p99 {p99:.3f} s   max {seconds.max():.3f} s"
