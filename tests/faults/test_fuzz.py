"""Rubbish is rejected by reason, costs nobody else anything and never reaches a fit.

`python -m benchmarks.faults.fuzz` sends more of it.
"""

from pathlib import Path

import numpy as np
import psutil
import pytest
import zenoh

from benchmarks.chain import patiently
from estimator.fit.identification import Identification, Options
from estimator.phasors.quality import Quality
from formats.wire import JSON, SampleBatch, encode_batch
from service.identification.computation import compute
from service.identification.task import IdentificationTask
from service.messaging.session import session as stream_session
from service.messaging.session import wait_connected
from service.runs.collector import Collector
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples, encode
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import RunRow
from tests.databases import NewDatabase
from tests.end_to_end.processes import Service, until
from tests.faults import disorder, fuzzing
from tests.faults.measured import measured
from tests.identification import chapter_3
from tests.plant import KEY, START, arrived, batch, document, listened_to
from tests.prompt_writer import PromptWriter

CASES = 3_000
HUGE = 64 << 20
HUGE_COUNT = 3
LARGEST_GROWTH = 50e6
FLIPPED = 17
"""One message in so many is in another unit than it says."""


def test_rubbish_is_counted_and_kept_out(plant: Database) -> None:
    fuzzed = fuzzing.Fuzzed(plant)
    fuzzed.run(CASES, number=1)
    fuzzed.check()
    assert fuzzed.cases == CASES
    assert len(fuzzed.reasons) >= 12, fuzzed.reasons
    assert fuzzed.taken > 0
    (outcome,) = SampleWriter(plant, Collector()).store(
        [arrived(batch([1000.0] * 5, source="another", start=START), received_at=fuzzing.RECEIVED_AT)], []
    )
    assert outcome.received == 5


@pytest.mark.long
def test_messages_of_64_mb_are_reported_and_let_go(tmp_path: Path) -> None:
    service = Service(tmp_path)
    with service.running() as serving, stream_session(listen=[], connect=[service.endpoint]) as stream:
        assert service.client.post("/machines", json=document()).status_code == 201
        assert wait_connected(stream, [service.endpoint], give_up=patiently)
        publisher = stream.declare_publisher(KEY.samples, congestion_control=zenoh.CongestionControl.BLOCK)
        until(lambda: listened_to(publisher), within_s=20, what="the service listens")

        def rejected() -> int:
            return int(service.get("/quarantine")["counts"].get("too_large", 0))

        def send(count: int) -> None:
            before = rejected()
            for _ in range(count):
                publisher.put(bytes(HUGE), encoding=JSON)
            until(lambda: rejected() == before + count, within_s=60, what="all are told")

        before = psutil.Process(serving.pid).memory_info().rss
        send(HUGE_COUNT)
        entry = service.get("/quarantine")["entries"][0]
        assert entry["size"] == HUGE
        publisher.put(encode_batch(measured(0), JSON), encoding=JSON)
        until(lambda: sum(row["received"] for row in service.get("/sources")) == 5, within_s=20, what="others are heard")
        until(
            lambda: psutil.Process(serving.pid).memory_info().rss - before < LARGEST_GROWTH,
            within_s=60,
            what="their memory is let go of",
        )
        publisher.undeclare()
    service.client.close()


def test_messages_in_another_unit_than_they_say_are_in_no_fit(new_database: NewDatabase, empty_template: str) -> None:
    """A source that says mil and sends µm for a moment: believable in size, and in nothing else."""
    machine = chapter_3()
    right = disorder.messages_of(machine, rate=1.0, sweeps=1, seed=3)
    wrong = disorder.messages_of(machine, rate=1.0, sweeps=1, seed=3)
    for one in wrong[5::FLIPPED]:
        one.amplitude = [[None if value is None else 25.4 * value for value in row] for row in one.amplitude]
    _, clean, _ = identified(new_database(empty_template), right)
    held, found, quality = identified(new_database(empty_template), wrong)
    moments = {moment for one in wrong[5::FLIPPED] for moment in one.time_ns}
    flipped = [place for place, moment in enumerate(held.time.tolist()) if moment in moments]
    assert len(flipped) > 20
    assert sum(found.outliers.values()) >= np.count_nonzero(quality.usable[flipped]) > 0
    assert found.accepted, found.verdict
    for estimate, expected in zip(found.estimates, clean.estimates, strict=True):
        if estimate.value is not None and expected.value is not None and expected.standard_error is not None:
            assert abs(estimate.value - expected.value) < expected.standard_error, estimate.name


def identified(database: Database, messages: list[SampleBatch]) -> tuple[Samples, Identification, Quality]:
    """The samples of the only run, what was identified from it, and its quality."""
    machine = chapter_3()
    with database.transaction() as session:
        machines.create(session, machine)
    PromptWriter(database).store([arrived(one) for one in messages], [])
    with database.reading() as session:
        (row,) = session.query(RunRow).filter_by(state=runs.CLOSED)
        held = runs.samples(session, row.id)
        text = machines.revision(session, machine.id, 1).document
    assert held is not None
    outcome = compute(IdentificationTask(text, [encode(held)], Options(), timeout_s=300.0, rules=machine.quality))
    assert outcome.identification is not None, outcome.error
    return held, outcome.identification, outcome.qualities[0]
