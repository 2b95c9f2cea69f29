"""Samples and their sources over a real database: to the bit, and once."""

import pytest
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from storage.database.engine import Database
from storage.encoding.sample_blocks import Samples
from storage.encoding.source_key import SourceKey
from storage.machines import machines
from storage.measurements import samples as sample_store
from tests.plant import (
    START,
    assert_same_samples,
    machine,
    samples,
)

MONITOR = SourceKey("pump-7", "monitor", 1)


def add_blocks(session: Session, *blocks: Samples, key: SourceKey = MONITOR, revision: int = 1) -> None:
    """Store blocks one after the other."""
    sequence = 0
    for block in blocks:
        sample_store.add_block(session, key, revision=revision, first_sequence=sequence, samples=block)
        sequence += len(block)


def times(found: Samples) -> list[int]:
    return [moment - START for moment in found.time.tolist()]


def test_stored_samples_come_back_to_the_bit(plant: Database) -> None:
    held = samples(10)
    with plant.transaction() as session:
        add_blocks(session, held)
    with plant.reading() as session:
        assert_same_samples(sample_store.latest(session, "pump-7", revision=1, count=10), held)


def test_between_takes_what_lies_in_it_by_time(plant: Database) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, start=START + 50, step=10), samples(5, step=10))
    with plant.reading() as session:
        found = sample_store.between(session, "pump-7", revision=1, first=START + 30, last=START + 60)
    assert times(found) == [30, 40, 50, 60]


@pytest.mark.parametrize(("first", "last"), [(-100, -1), (41, 49), (95, 200), (60, 50)])
def test_between_without_samples_is_empty(plant: Database, first: int, last: int) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        assert len(sample_store.between(session, "pump-7", revision=1, first=START + first, last=START + last)) == 0


def test_samples_belong_to_a_machine_and_revision(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        machines.revise(session, machine(name="New"))
        add_blocks(session, samples(2))
        add_blocks(session, samples(3, start=START + 100), key=SourceKey("pump-7", "monitor", 2), revision=2)
    with plant.reading() as session:
        assert len(sample_store.latest(session, "pump-7", revision=1, count=10)) == 2
        assert len(sample_store.latest(session, "pump-7", revision=2, count=10)) == 3
        assert len(sample_store.latest(session, "other", revision=1, count=10)) == 0


@pytest.mark.parametrize("count", [1, 4, 5, 7, 100])
def test_latest_takes_the_newest_by_time(plant: Database, count: int) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, count=count)
    assert times(found) == list(range(0, 100, 10))[-count:]


def test_latest_of_two_sources_at_once_takes_the_newest_of_both(plant: Database) -> None:
    with plant.transaction() as session:
        add_blocks(session, samples(11, step=10))
        add_blocks(session, samples(10, start=START + 5, step=10), key=SourceKey("pump-7", "second", 1))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, count=4)
    assert times(found) == [85, 90, 95, 100]


@pytest.mark.parametrize(
    ("first", "last", "count", "expected"),
    [
        (None, 60, 3, [40, 50, 60]),
        (20, 55, 10, [20, 30, 40, 50]),
        (90, None, 10, [90]),
        (41, 49, 10, []),
        (60, 50, 10, []),
        (None, -1, 10, []),
    ],
)
def test_latest_within_a_time_range(
    plant: Database, first: int | None, last: int | None, count: int, expected: list[int]
) -> None:
    begin, end = (None if moment is None else START + moment for moment in (first, last))
    with plant.transaction() as session:
        add_blocks(session, samples(5, step=10), samples(5, start=START + 50, step=10))
    with plant.reading() as session:
        found = sample_store.latest(session, "pump-7", revision=1, channels=2, count=count, first=begin, last=end)
    assert times(found) == expected


def test_the_same_samples_cannot_be_stored_twice(plant: Database) -> None:
    def twice() -> None:
        with plant.transaction() as session:
            add_blocks(session, samples(2))
            add_blocks(session, samples(2))

    with pytest.raises(IntegrityError, match=r"(?i)unique"):
        twice()


def test_a_source_begins_at_nothing_and_keeps_its_counts(plant: Database) -> None:
    with plant.transaction() as session:
        row = sample_store.source(session, MONITOR)
        assert (row.next_sequence, row.received, row.duplicates, row.lost, row.last_time) == (0, 0, 0, 0, 0)
        row.next_sequence, row.lost = 7, 2
    with plant.reading() as session:
        assert sample_store.source(session, MONITOR).next_sequence == 7
        assert sample_store.source(session, SourceKey("pump-7", "monitor", 2)).next_sequence == 0


def test_sources_of_one_machine_or_of_all(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="other"))
        for key in (MONITOR, SourceKey("other", "monitor", 1), SourceKey("pump-7", "alternate", 5)):
            sample_store.source(session, key)
    with plant.reading() as session:
        assert [(row.machine_id, row.source) for row in sample_store.sources(session)] == [
            ("other", "monitor"),
            ("pump-7", "alternate"),
            ("pump-7", "monitor"),
        ]
        assert len(sample_store.sources(session, "pump-7")) == 2
