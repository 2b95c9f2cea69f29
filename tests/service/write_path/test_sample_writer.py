"""The writer: every sample stored once, whatever comes twice or in pieces; what is missing counted, what is wrong kept
apart; all of a call or nothing of it; and a restart that nobody notices in the data."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sqlalchemy import select, text
from sqlalchemy.exc import DBAPIError
from sqlalchemy.orm import Session

from formats.wire import SampleBatch, source_key
from service.runs.collector import Collector
from service.write_path import write_batch
from service.write_path.batch import ArrivedBatch, StoreOutcome
from service.write_path.sample_writer import SampleWriter
from service.write_path.source_backoff import SourceBackoff
from service.write_path.write_batch import WriteBatch
from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.findings import jobs
from storage.machines import machines
from storage.measurements import quarantine, runs
from storage.measurements import samples as sample_store
from storage.measurements.quarantine import Rejection
from storage.tables.measurements import QuarantineRow, SourceRow
from tests.databases import Databases, NewDatabase, opened
from tests.plant import (
    KEY,
    SECOND,
    START,
    arrived,
    assert_same_samples,
    batch,
    few_examples,
    machine,
    sweep_rpm,
)
from tests.prompt_writer import PromptWriter

MONITOR = SourceKey("pump-7", "monitor", 1)
SPEEDS = sweep_rpm(900.0, 1200.0, 12)


def piece(first: int, last: int, speeds: Sequence[float] = SPEEDS, **changes: Any) -> SampleBatch:
    """Samples number `first` to before `last` of a source that publishes `speeds`, a second apart."""
    return batch(speeds[first:last], sequence=first, start=START + first * 10**9, **changes)


def store(writer: PromptWriter, *batches: SampleBatch) -> None:
    """Each batch in a call of its own, as they would come one after the other."""
    for one in batches:
        writer.store([arrived(one)], [])


def held(database: Database, *, revision: int = 1) -> Samples:
    with database.reading() as session:
        return sample_store.latest(session, "pump-7", revision=revision, count=10_000)


def numbers(database: Database) -> list[int]:
    """Return which samples of the source are stored, by their times."""
    return [(moment - START) // 10**9 for moment in held(database).time.tolist()]


def counts(database: Database, key: SourceKey = MONITOR) -> tuple[int, int, int, int]:
    """Next sequence, received, duplicates, lost."""
    with database.reading() as session:
        row = sample_store.source(session, key)
        return row.next_sequence, row.received, row.duplicates, row.lost


def rejected(database: Database) -> list[QuarantineRow]:
    with database.reading() as session:
        return list(session.scalars(select(QuarantineRow).order_by(QuarantineRow.id)))


def test_samples_are_stored_as_they_came(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 5), piece(5, 12))
    assert numbers(plant) == list(range(12))
    assert counts(plant) == (12, 12, 0, 0)
    assert rejected(plant) == []


def test_several_batches_of_a_call_are_as_good_as_several_calls(plant: Database, writer: PromptWriter) -> None:
    writer.store([arrived(piece(0, 5)), arrived(piece(5, 7)), arrived(piece(7, 12))], [])
    assert numbers(plant) == list(range(12))
    assert counts(plant) == (12, 12, 0, 0)


def test_what_comes_twice_is_stored_once(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 5), piece(0, 5), piece(2, 4))
    writer.store([arrived(piece(5, 8)), arrived(piece(5, 8))], [])
    assert numbers(plant) == list(range(8))
    assert counts(plant) == (8, 8, 5 + 2 + 3, 0)
    assert rejected(plant) == []


def test_of_a_batch_that_overlaps_only_the_new_part_is_stored(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 5), piece(3, 9))
    assert numbers(plant) == list(range(9))
    assert counts(plant) == (9, 9, 2, 0)


def test_a_gap_is_counted_as_lost(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(2, 4), piece(7, 9))
    assert numbers(plant) == [2, 3, 7, 8]
    assert counts(plant) == (9, 4, 0, 2 + 3)


def test_what_a_short_transaction_has_no_time_for_is_left_for_the_next(plant: Database, writer: PromptWriter) -> None:
    every = [arrived(piece(first, first + 2)) for first in range(0, 12, 2)]
    assert len(writer.store(every, [], within_s=0.0)) == 1
    assert numbers(plant) == [0, 1]
    held = WriteBatch(writer, SourceBackoff())
    for one in every[1:]:
        held.take(one)
    turns = 0
    while len(held):
        held.store()
        turns += 1
    assert numbers(plant) == list(range(12))
    assert turns <= len(every) - 1


class OnlyOneAtATime(SampleWriter):
    """Has time for one batch in each transaction, whatever time it is given."""

    def __init__(self, database: Database) -> None:
        super().__init__(database, Collector())
        self.within_s: list[float] = []

    def store(self, arrived: list[ArrivedBatch], rejections: list[Rejection], *, within_s: float = 0.0) -> list[StoreOutcome]:
        self.within_s.append(within_s)
        return super().store(arrived, rejections, within_s=0.0)


def test_transactions_may_last_longer_while_more_is_held_than_they_have_time_for(plant: Database) -> None:
    writer = OnlyOneAtATime(plant)
    held = WriteBatch(writer, SourceBackoff())
    for first in range(6):
        held.take(arrived(piece(first, first + 1)))
    held.store_all()
    assert numbers(plant) == list(range(6))
    short, longest = write_batch.LONGEST_TRANSACTION_S, write_batch.LONGEST_WHEN_BEHIND_S
    assert writer.within_s == [short, 2 * short, 4 * short, longest, longest, longest]
    for first in (6, 7):
        held.take(arrived(piece(first, first + 1)))
        held.store()
    assert writer.within_s[6:] == [short, short]


@few_examples
@given(st.lists(st.tuples(st.integers(0, 11), st.integers(1, 6), st.booleans()), min_size=1, max_size=8))
def test_any_pieces_in_any_order_store_each_sample_at_most_once(
    databases: Databases, plant_template: str, tmp_path_factory: pytest.TempPathFactory, pieces: list[tuple[int, int, bool]]
) -> None:
    """Each sample that comes at all is stored, once; what never came is lost, and what came again a duplicate."""
    with opened(databases, plant_template, tmp_path_factory.mktemp("samples") / "samples.db") as database:
        writer = PromptWriter(database, Collector())
        waiting: list[ArrivedBatch] = []
        expected: set[int] = set()
        sent = 0
        for first, size, last_of_call in pieces:
            last = min(first + size, 12)
            expected |= set(range(first, last))
            sent += last - first
            waiting.append(arrived(piece(first, last)))
            if last_of_call:
                writer.store(waiting, [])
                waiting = []
        writer.store(waiting, [])
        assert numbers(database) == sorted(expected)
        next_sequence, received, duplicates, lost = counts(database)
        assert next_sequence == max(expected) + 1
        assert received == len(expected)
        assert received + lost == next_sequence
        assert received + duplicates == sent
        with database.reading() as session:
            missing = sample_store.source(session, MONITOR).missing or []
        assert {n for first, last, *_ in missing for n in range(first, last + 1)} == set(range(next_sequence)) - expected


def test_the_next_sequence_outlives_the_service(plant: Database, writer: PromptWriter) -> None:
    assert writer.next_sequence(MONITOR) == 0
    store(writer, piece(0, 5))
    again = PromptWriter(plant, Collector())
    assert again.next_sequence(MONITOR) == 5
    assert again.next_sequence(SourceKey("pump-7", "monitor", 2)) == 0
    store(again, piece(3, 8))
    assert numbers(plant) == list(range(8))


def test_asking_for_a_sequence_leaves_nothing_behind(plant: Database, writer: PromptWriter) -> None:
    writer.next_sequence(MONITOR)
    with plant.reading() as session:
        assert session.scalars(select(SourceRow)).all() == []


def test_each_start_of_a_source_counts_for_itself(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 5))
    restarted = batch(SPEEDS[:3], epoch=2, start=START + 100 * 10**9)
    store(writer, restarted)
    assert counts(plant) == (5, 5, 0, 0)
    assert counts(plant, source_key(restarted)) == (3, 3, 0, 0)
    assert len(held(plant)) == 8


def test_the_plant_of_a_machine_is_known_as_soon_as_the_machine_is(plant: Database, writer: PromptWriter) -> None:
    assert writer.plant_of("pump-7") == "plant-1"
    assert writer.plant_of("pump-8") is None
    with plant.transaction() as session:
        machines.create(session, machine(id="pump-8"))
    assert writer.plant_of("pump-8") == "plant-1"


# --- what is rejected -----------------------------------------------------------------------------------------------


def test_rejected_samples_are_kept_apart_and_the_rest_is_stored(plant: Database, writer: PromptWriter) -> None:
    one = piece(0, 6)
    one.speed[1] = -5.0
    one.time_ns[3] = one.time_ns[2]
    one.speed[5] = 3000.0
    one.time_ns[5] = one.time_ns[4] + 10**8
    store(writer, one)
    assert numbers(plant) == [0, 2, 4]
    assert counts(plant) == (6, 3, 0, 0)
    assert [row.reason for row in rejected(plant)] == ["speed_out_of_range", "time_out_of_order", "speed_out_of_order"]
    with plant.reading() as session:
        assert quarantine.counts(session) == {"speed_out_of_range": 1, "time_out_of_order": 1, "speed_out_of_order": 1}


def test_a_rejected_sample_says_where_it_came_from(plant: Database, writer: PromptWriter) -> None:
    one = piece(2, 4)
    one.speed[1] = -5.0
    store(writer, one)
    (row,) = rejected(plant)
    assert (row.key, row.machine_id) == ("rundown/v1/plant-1/pump-7/samples", "pump-7")
    assert b"'sequence': 3" in row.payload
    assert b"'speed': -5.0" in row.payload
    assert "-" in row.detail


def test_a_sample_with_one_wrong_channel_is_stored_without_it(plant: Database, writer: PromptWriter) -> None:
    one = piece(0, 2)
    one.amplitude[1][2] = 1e9
    store(writer, one)
    assert numbers(plant) == [0, 1]
    assert held(plant).usable.tolist() == [[True] * 4, [True, True, False, True]]
    assert [row.reason for row in rejected(plant)] == ["amplitude_out_of_range"]


def test_a_batch_that_cannot_be_converted_is_kept_apart_whole(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 3, speed_unit="RPM"), piece(3, 5))
    assert numbers(plant) == [3, 4]
    assert counts(plant) == (5, 2, 0, 0)
    (row,) = rejected(plant)
    assert (row.reason, row.machine_id) == ("wrong_unit", "pump-7")
    assert row.payload.startswith(b"rundown/1 ")


def test_duplicates_of_wrong_samples_are_rejected_once(plant: Database, writer: PromptWriter) -> None:
    one = piece(0, 4)
    one.speed[1] = -5.0
    one.amplitude[0][0] = 1e9
    store(writer, one, one)
    longer = piece(0, 5)
    longer.speed[1] = -5.0
    longer.amplitude[0][0] = 1e9
    store(writer, longer)
    assert sorted(row.reason for row in rejected(plant)) == ["amplitude_out_of_range", "speed_out_of_range"]
    assert numbers(plant) == [0, 2, 3, 4]


def test_rejected_messages_are_filed_with_the_samples(plant: Database, writer: PromptWriter) -> None:
    writer.store([arrived(piece(0, 2))], [Rejection(START, "some/key", None, "bad_frame", "no frame", b"noise")])
    assert numbers(plant) == [0, 1]
    assert [row.reason for row in rejected(plant)] == ["bad_frame"]


@pytest.mark.parametrize(
    "changes", [{"speed_unit": "\0"}, {"channels": ["\0", "B2Y", "B3X", "B3Y"]}, {"status": [["\0"] * 4]}]
)
def test_what_is_filed_can_be_filed_as_text(plant: Database, writer: PromptWriter, changes: dict[str, Any]) -> None:
    """PostgreSQL takes no NUL in text: such a message could never be filed, and everything behind it would wait for ever."""
    store(writer, batch(**changes))
    (row,) = rejected(plant)
    assert "\0" not in row.detail


def test_a_source_that_starts_again_while_time_stands_is_rejected_by_time(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 5))
    again = PromptWriter(plant, Collector())
    late = batch(SPEEDS[:2], sequence=5, start=START + 10**9)
    store(again, late)
    assert [row.reason for row in rejected(plant)] == ["time_out_of_order"] * 2


# --- all or nothing -------------------------------------------------------------------------------------------------


def everything(database: Database) -> dict[str, list[tuple[Any, ...]]]:
    """All rows of all tables that an arriving message may change."""
    names = ("sample_blocks", "sources", "collectors", "runs", "identification_jobs", "quarantine", "quarantine_counts")
    with database.reading() as session:
        return {name: [tuple(row) for row in session.execute(text(f"SELECT * FROM {name}"))] for name in names}


def test_nothing_is_stored_when_the_transaction_fails(plant: Database, writer: PromptWriter) -> None:
    """A sweep far enough to open a run, beside a rejection; the last of its writes is refused by the database."""
    store(writer, piece(0, 12))
    before = everything(plant)
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE quarantine_counts RENAME TO away"))
    sweep = batch(sweep_rpm(1200.0, 2500.0, 12), sequence=12, start=START + 12 * 10**9)
    noise = Rejection(START, "some/key", None, "bad_frame", "no frame", b"noise")
    with pytest.raises(DBAPIError, match="quarantine_counts"):
        writer.store([arrived(sweep)], [noise])
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE away RENAME TO quarantine_counts"))
    assert everything(plant) == before
    writer.store([arrived(sweep)], [noise])
    assert len(held(plant)) == 24
    assert [row.reason for row in rejected(plant)] == ["bad_frame"]


def test_a_message_of_a_machine_that_is_not_there_stores_nothing(plant: Database, writer: PromptWriter) -> None:
    before = everything(plant)
    with pytest.raises(machines.MachineUnknown):
        writer.store([arrived(piece(0, 3)), arrived(batch(machine="pump-8"))], [])
    assert everything(plant) == before


# --- restarts -------------------------------------------------------------------------------------------------------

# A coast-down, a run-up, a little of a coast-down: two whole runs and the beginning of a third.
SWEEPS = [*sweep_rpm(2990.0, 400.0, 30), *sweep_rpm(450.0, 2900.0, 30), *sweep_rpm(2800.0, 2000.0, 10)]


def collected(database: Database) -> list[tuple[Any, ...]]:
    with database.reading() as session:
        rows = runs.of_machine(session, "pump-7")
        return [(row.kind, row.state, row.reason, row.time_first, row.time_last, row.count) for row in rows]


def collected_samples(session: Session) -> list[Samples]:
    every = [runs.samples(session, row.id) for row in runs.of_machine(session, "pump-7")]
    return [one for one in every if one is not None]


@pytest.fixture
def at_a_stretch(new_database: NewDatabase, plant_template: str) -> Database:
    """Return what one service makes of the sweeps in one message."""
    database = new_database(plant_template)
    store(PromptWriter(database, Collector()), piece(0, len(SWEEPS), SWEEPS))
    return database


@pytest.mark.parametrize("cuts", [[1], [15], [29, 30, 31], [33], [61], list(range(1, len(SWEEPS)))])
def test_a_run_over_restarts_is_the_run_at_a_stretch(plant: Database, at_a_stretch: Database, cuts: list[int]) -> None:
    for first, last in zip([0, *cuts], [*cuts, len(SWEEPS)], strict=True):
        store(PromptWriter(plant, Collector()), piece(first, last, SWEEPS))
    expected = collected(at_a_stretch)
    assert [row[:2] for row in expected] == [("run-down", "open"), ("run-up", "closed"), ("run-down", "closed")]
    assert collected(plant) == expected
    with plant.reading() as session, at_a_stretch.reading() as other:
        for found, wanted in zip(collected_samples(session), collected_samples(other), strict=True):
            assert_same_samples(found, wanted)
        assert jobs.count(session) == jobs.count(other) == {jobs.QUEUED: 2}


def test_a_revision_takes_effect_with_the_next_message(plant: Database, writer: PromptWriter) -> None:
    store(writer, piece(0, 3))
    with plant.transaction() as session:
        machines.revise(session, machine(name="New"))
    store(writer, piece(3, 7))
    assert len(held(plant, revision=1)) == 3
    assert len(held(plant, revision=2)) == 4
    assert counts(plant) == (7, 7, 0, 0)


def test_an_absurd_sequence_is_rejected_and_deafens_nothing(plant: Database, writer: PromptWriter) -> None:
    store(writer, batch([1000.0] * 3))
    store(writer, batch([1000.0], sequence=2**61, start=START + 10 * SECOND))
    store(writer, batch([1000.0] * 2, sequence=3, start=START + 20 * SECOND))
    assert [row.reason for row in rejected(plant)] == ["sequence_out_of_range"]
    with plant.reading() as session:
        (source,) = sample_store.sources(session)
        assert (source.next_sequence, source.received, source.lost, source.duplicates) == (5, 5, 0, 0)


def test_a_run_told_again_by_a_new_start_counts_each_instant_once(plant: Database, writer: PromptWriter) -> None:
    sweep = sweep_rpm(2900.0, 310.0, 60)
    store(writer, batch(sweep[:30], epoch=1))
    store(writer, batch([*sweep, 200.0, 200.0], epoch=2))
    with plant.reading() as session:
        (run,) = runs.of_machine(session, KEY.machine)
        kept = runs.samples(session, run.id)
        assert kept is not None
        assert run.state == runs.CLOSED
        assert len(kept) == len(set(kept.time.tolist())) == 60
        assert [source.late for source in sample_store.sources(session)] == [0, 30]


def test_of_a_batch_that_is_wrong_throughout_a_few_faults_are_kept_and_all_are_counted(plant: Database) -> None:
    writer = PromptWriter(plant, Collector())
    store(writer, piece(0, 10, amplitude_unit="mm"))
    store(writer, piece(10, 12, time_ns=[0, 0]))
    with plant.reading() as session:
        assert quarantine.counts(session) == {"amplitude_out_of_range": 40, "time_out_of_range": 2}
        kept = quarantine.newest(session, reason="amplitude_out_of_range", machine_id=None, limit=100)
        assert len(kept) == 5
        assert kept[0].detail.endswith("; and 35 more in this batch")
        assert len(quarantine.newest(session, reason="time_out_of_range", machine_id=None, limit=100)) == 2
