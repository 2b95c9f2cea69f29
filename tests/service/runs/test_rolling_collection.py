"""Rolling collection: a machine whose speed wanders, its bins and the runs that they make."""

from typing import Any

import numpy as np
import pytest

from service.runs.collection_state import state_of
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import machines
from storage.measurements import runs
from storage.tables.measurements import RunRow
from tests.databases import NewDatabase
from tests.plant import KEY, SECOND, START, arrived, batch, identification, machine, store_identification
from tests.prompt_writer import PromptWriter

RULES = {"bins": 10, "samples_per_bin": 4, "spacing_s": 5.0, "recency_s": 3600.0, "coverage": 0.8, "interval_s": 600.0}


@pytest.fixture
def rolling(plant: Database) -> Database:
    """The plant's machine with rolling collection; revision 2."""
    with plant.transaction() as session:
        machines.revise(session, machine(collection={"runs": "rolling", "rolling": RULES}))
    return plant


def wander(count: int, seed: int = 0, *, low: float = 400.0, high: float = 2900.0) -> list[float]:
    """A speed that wanders slowly between two limits, a sample a second."""
    rng = np.random.default_rng(seed)
    phases = rng.uniform(0, 2 * np.pi, 3)
    second = np.arange(count)
    wave = sum(np.sin(2 * np.pi * second / period + phase) for period, phase in zip((311, 173, 97), phases, strict=True))
    shape = (np.asarray(wave) - np.min(wave)) / (np.max(wave) - np.min(wave))
    return list(map(float, low + (high - low) * shape))


def send(writer: PromptWriter, rpm: list[float], first: int, last: int, **changes: Any) -> None:
    for start in range(first, last, 60):
        stop = min(start + 60, last)
        writer.store([arrived(batch(rpm[start:stop], sequence=start, start=START + start * SECOND, **changes))], [])


def found_runs(database: Database) -> list[RunRow]:
    with database.reading() as session:
        return list(reversed(runs.of_machine(session, KEY.machine)))


def test_a_wandering_speed_makes_a_run_when_its_time_has_come(rolling: Database, writer: PromptWriter) -> None:
    speeds = wander(1300)
    send(writer, speeds, 0, 600)
    assert found_runs(rolling) == []
    send(writer, speeds, 600, 1300)
    first, second = found_runs(rolling)
    for run in (first, second):
        assert (run.kind, run.state, run.revision) == ("rolling", runs.CLOSED, 2)
        assert run.count is not None
        assert 20 <= run.count <= 40
        assert run.coverage is not None
        assert run.coverage["part"] > 0.7
    # Each run has samples of its own.
    assert first.time_last is not None
    assert first.time_last < second.time_first
    with rolling.reading() as session:
        assert [job.run_ids for job in jobs.of_machine(session, KEY.machine, limit=10)] == [[second.id], [first.id]]
        held = runs.samples(session, first.id)
    assert held is not None
    assert np.all(np.diff(held.time) > 0)
    numbers = (held.time - START) // SECOND
    assert held.speed * 30 / np.pi == pytest.approx(np.array(speeds)[numbers])


def test_without_coverage_there_is_no_run(rolling: Database, writer: PromptWriter) -> None:
    send(writer, wander(1300, high=1500.0), 0, 1300)
    assert found_runs(rolling) == []


def test_old_samples_do_not_count(rolling: Database, writer: PromptWriter) -> None:
    """Half of the bins were filled two hours ago, the other half now: never enough of them at a time."""
    send(writer, wander(500, high=1500.0), 0, 500)
    later = batch(wander(500, low=1700.0), sequence=500, start=START + 7200 * SECOND)
    writer.store([arrived(later)], [])
    assert found_runs(rolling) == []


def test_a_restart_at_any_message_changes_nothing(rolling: Database, new_database: NewDatabase, plant_template: str) -> None:
    speeds = wander(1300)
    for first in range(0, 1300, 60):
        send(PromptWriter(rolling, Collector()), speeds, first, min(first + 60, 1300))
    at_a_stretch = new_database(plant_template)
    with at_a_stretch.transaction() as session:
        machines.revise(session, machine(collection={"runs": "rolling", "rolling": RULES}))
    send(PromptWriter(at_a_stretch, Collector()), speeds, 0, 1300)
    told = [
        [(run.time_first, run.time_last, run.count, run.coverage) for run in found_runs(one)]
        for one in (rolling, at_a_stretch)
    ]
    assert told[0] == told[1]
    assert len(told[0]) == 2


def test_what_is_remembered_is_bounded(rolling: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("storage.measurements.runs.end_rolling", lambda *_args, **_more: None)
    send(writer, wander(3000, high=1500.0), 0, 3000)
    with rolling.reading() as session:
        now = state_of(session, KEY.machine)
    assert now is not None
    assert now.bins is not None
    assert all(len(times) <= 4 for times in now.bins.times)


def test_the_other_sense_of_rotation_begins_again(rolling: Database, writer: PromptWriter) -> None:
    speeds = wander(1300)
    send(writer, speeds, 0, 540)
    send(writer, speeds, 540, 1100, direction="negative")
    (run,) = found_runs(rolling)
    assert run.direction == -1
    assert run.time_first >= START + 540 * SECOND


def test_both_collects_sweeps_too(plant: Database, writer: PromptWriter) -> None:
    with plant.transaction() as session:
        machines.revise(session, machine(collection={"runs": "both", "rolling": RULES}))
    send(writer, [*wander(700), *np.linspace(2900.0, 200.0, 100).tolist(), *[0.0] * 20], 0, 820)
    kinds = {run.kind for run in found_runs(plant)}
    assert kinds == {"rolling", "run-up", "run-down"}


def test_rolling_runs_are_compared_with_their_like_and_gathered_with_none(plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(4):
            kind = "rolling" if number % 2 else "run-down"
            row = runs.open_run(session, KEY.machine, revision=1, kind=kind, direction=1, time_first=START + number)
            row.state = runs.CLOSED
            session.flush()
            store_identification(session, identification(), run_id=row.id, run_kind=kind, measured_at=START + number)
        gathered = runs.newest_closed(session, KEY.machine, revision=1, limit=10)
        assert [row.kind for row in gathered] == ["run-down", "run-down"]
        found = identifications.of_machine(session, KEY.machine)
        assert sorted(row.run_kind for row in found) == ["rolling", "rolling", "run-down", "run-down"]
