"""Replicas killed at random under load: samples from a source with a log, samples over HTTP, identifications under way."""

import random
import sqlite3
import statistics
import threading
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import httpx
import numpy as np

from formats.wire import JSON, encode_body
from storage.database.engine import Database
from storage.encoding.sample_blocks import decode, join
from storage.findings import identifications, jobs
from storage.machines import machines
from storage.tables.findings import JobRow
from storage.tables.measurements import SampleBlockRow, SourceRow
from tests.distribution.layout import Layout
from tests.end_to_end.processes import until
from tests.faults.measured import STEP, expected, measured
from tests.identification import chapter_3, close_run, counts
from tests.plant import CHANNELS, KEY, START, assert_same_samples, document

ROLES = ("api1", "ingest1", "ingest2", "identify1")
ALONE = ("all1",)
POSTED = "pump-8"
"""The machine whose samples come over HTTP."""
RATE = 100.0
SLOT_S = 4.0
"""One kill in each, at a random moment."""
EARLY = 0.2
"""Part of the kills that hit what was killed before while it still starts."""
READY_WITHIN_S = 60.0
"""A service that starts while others keep the machine busy takes its time; how long it took is told."""
POSTED_SIZE = 20
DRAINED_WITHIN_S = 180.0


@dataclass(frozen=True)
class Killed:
    """kills: by replica. ready_s: from each start of a process to its readiness, of those that lived so long.

    samples: stored, from the log and over HTTP. repeated: that came over HTTP again because no answer had come.
    """

    kills: dict[str, int]
    ready_s: tuple[float, ...]
    samples: tuple[int, int]
    repeated: int
    identified: int

    def __str__(self) -> str:
        kills = ", ".join(f"{name} {count}" for name, count in sorted(self.kills.items()))
        return (
            f"killed {kills}; ready after {statistics.median(self.ready_s):.1f} s (median), "
            f"{max(self.ready_s):.1f} s (longest); {self.samples[0]} samples from the log, {self.samples[1]} over HTTP "
            f"({self.repeated} sent again), {self.identified} identifications"
        )


@dataclass
class Posting:
    """A thread that sends samples over HTTP to any replica, each batch again until one has acknowledged it."""

    layout: Layout
    names: Sequence[str]
    rng: random.Random
    acknowledged: int = 0
    repeated: int = 0
    unexpected: list[str] = field(default_factory=list)

    def run(self, stop: threading.Event) -> None:
        """Run until it is stopped and the last batch is acknowledged."""
        with httpx.Client(trust_env=False, timeout=20.0) as client:
            while not stop.wait(POSTED_SIZE / RATE):
                body = encode_body(measured(self.acknowledged, POSTED_SIZE, machine=POSTED), JSON)
                while not self._took(client, body):
                    self.repeated += 1
                    time.sleep(0.2)
                self.acknowledged += POSTED_SIZE

    def _took(self, client: httpx.Client, body: bytes) -> bool:
        base = self.layout.client(self.rng.choice(self.names)).base_url
        try:
            answer = client.post(f"{base}machines/{POSTED}/samples", content=body, headers={"content-type": JSON})
        except httpx.TransportError:
            return False  # killed before it answered, or not there
        if answer.status_code not in (200, 503):
            self.unexpected.append(f"{answer.status_code} {answer.text}")
        return answer.status_code == 200


def killed_at_random(
    folder: Path, *, database: str, names: Sequence[str], seed: int, kills: int, identified: int = 6
) -> Killed:
    """One replica after the other is killed at a random moment and started again; in the end all is there, once."""
    rng = random.Random(seed)
    samples = round(RATE * SLOT_S * kills)
    told: Counter[str] = Counter()
    ready_s: list[float] = []
    left: list[str] = []
    with Layout(folder, database=database) as layout:
        for name in names:  # one after the other: all at once would wait for each other's imports
            layout.start_ready(name)
        layout.create_machine(names[0])
        layout.create_machine(names[0], document(id=POSTED))
        store = Database(database)
        _ask_identifications(store, identified)
        posting, stop = Posting(layout, names, random.Random(seed + 1)), threading.Event()
        thread = threading.Thread(target=posting.run, args=(stop,))
        layout.start_source(samples=samples, rate=RATE)
        thread.start()
        try:
            while told.total() < kills:
                time.sleep(rng.uniform(0.0, SLOT_S))
                if not left:  # each as often as the others
                    left = rng.sample(names, len(names))
                name = left.pop()
                layout.kill(name)
                told[name] += 1
                if told.total() < kills and rng.random() < EARLY:
                    layout.start(name)
                    time.sleep(rng.uniform(0.0, 2.0))
                    layout.kill(name)
                    told[name] += 1
                ready_s.append(_ready_again(layout, name))
        finally:
            stop.set()
            thread.join()
        assert posting.unexpected == []
        until(lambda: _durable(store) >= samples, within_s=DRAINED_WITHIN_S, what=f"{samples} samples stored")
        until(lambda: counts(store) == {jobs.DONE: identified}, within_s=DRAINED_WITHIN_S, what="all jobs done")
        _check_store(store, {KEY.machine: samples, POSTED: posting.acknowledged})
        _check_identifications(store, identified)
        store.close()
    _check_file(database)
    for name in names:
        assert "Traceback" not in (folder / f"{name}.log").read_text(), name
    return Killed(dict(told), tuple(ready_s), (samples, posting.acknowledged), posting.repeated, identified)


def _ready_again(layout: Layout, name: str) -> float:
    began = time.monotonic()
    layout.start(name)
    until(lambda: layout._ready(name), within_s=READY_WITHIN_S, what=f"{name} is ready again")
    return time.monotonic() - began


def _ask_identifications(store: Database, count: int) -> None:
    train = chapter_3()
    with store.transaction() as session:
        machines.create(session, train)
    for number in range(count):
        close_run(store, train, seed=number, start_s=1_700_000_000 + 3600 * number)


def _durable(store: Database) -> int:
    with store.reading() as session:
        return sum(row.received for row in session.query(SourceRow).filter_by(machine_id=KEY.machine))


def _faults(numbers: Sequence[int], count: int) -> tuple[list[int], list[int]]:
    """List the samples that are missing, and those stored more than once or never measured."""
    times = Counter(numbers)
    return [k for k in range(count) if k not in times], [k for k in times if times[k] > 1 or not 0 <= k < count]


def _check_store(store: Database, samples: dict[str, int]) -> None:
    """Require that the store holds what was measured of each machine, once, and counts it so.

    A sample's time says which it is: a block may hold recalled samples beside those that came then.
    """
    with store.reading() as session:
        for machine_id, count in samples.items():
            rows = session.query(SampleBlockRow).filter_by(machine_id=machine_id).order_by(SampleBlockRow.first_sequence).all()
            held = join([decode(row.data) for row in rows], channels=len(CHANNELS))
            numbers = ((held.time - START) // STEP).tolist()
            assert sorted(numbers) == list(range(count)), f"{machine_id}: missing, wrong {_faults(numbers, count)}"
            assert_same_samples(held.pick(np.argsort(held.time)), expected(count))
            (source,) = session.query(SourceRow).filter_by(machine_id=machine_id).all()
            assert (source.received, source.next_sequence, source.lost) == (count, count, 0), machine_id


def _check_identifications(store: Database, count: int) -> None:
    """Each job has one result, however often it was begun."""
    with store.reading() as session:
        found = [row.job_id for row in identifications.of_machine(session, chapter_3().id)]
        assert sorted(found) == sorted(row.id for row in session.query(JobRow))
        assert len(found) == count


def _check_file(database: str) -> None:
    """An SQLite file is whole."""
    if not database.startswith("sqlite"):
        return
    connection = sqlite3.connect(database.removeprefix("sqlite:///"))
    try:
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        assert connection.execute("PRAGMA foreign_key_check").fetchall() == []
    finally:
        connection.close()
