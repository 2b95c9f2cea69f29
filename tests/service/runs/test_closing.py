"""Runs end in the thread that stores and are closed in another one: nothing is lost in between."""

import threading

import pytest
from sqlalchemy.orm import Session

from service.runs import closing
from service.runs.closing import Closing
from service.runs.collector import Collector
from service.runs.run_samples import RunContent, gather
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.findings import jobs
from storage.measurements import runs
from storage.tables.measurements import RunRow
from tests.plant import KEY, SECOND, START, arrived, batch, sweep_rpm, wait_until

CYCLE = [*[2990.0] * 20, *sweep_rpm(2990.0, 310.0, 80), *[250.0] * 20]


@pytest.fixture
def collector() -> Collector:
    return Collector(late_s=0.0)


@pytest.fixture
def writer(plant: Database, collector: Collector) -> SampleWriter:
    return SampleWriter(plant, collector)


def send(writer: SampleWriter, first: int, last: int) -> None:
    one = batch(CYCLE[first:last], sequence=first, start=START + first * SECOND)
    writer.store([arrived(one, received_at=START + 10**6 * SECOND)], [])


def only_run(database: Database) -> RunRow:
    with database.reading() as session:
        (run,) = runs.of_machine(session, KEY.machine)
        return run


def asked(database: Database) -> list[dict[str, int] | None]:
    with database.reading() as session:
        return [job.options for job in reversed(jobs.of_machine(session, KEY.machine, limit=10))]


def test_a_run_that_has_ended_is_closed_after_a_restart_too(plant: Database, writer: SampleWriter) -> None:
    send(writer, 0, len(CYCLE))
    run = only_run(plant)
    assert (run.state, run.reason, run.count) == (runs.ENDED, "the speed left the speed range", None)
    Closing(plant, Collector()).close_ended()
    run = only_run(plant)
    assert (run.state, run.count) == (runs.CLOSED, 85)
    with plant.reading() as session:
        assert runs.extent(session, run.id) == {"first": run.time_first, "last": run.time_last}
    assert asked(plant) == [None]


def test_storing_goes_on_while_a_run_is_being_closed(
    plant: Database, writer: SampleWriter, collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun, go_on = threading.Event(), threading.Event()

    def slowly(session: Session, row: RunRow) -> RunContent:
        found = gather(session, row)
        begun.set()
        assert go_on.wait(10.0)
        return found

    monkeypatch.setattr(closing, "gather", slowly)
    thread = Closing(plant, collector)
    thread.start()
    try:
        send(writer, 0, 110)
        assert begun.wait(10.0)
        send(writer, 110, 120)  # would wait for the writer's turn, and end in an error
        go_on.set()
        wait_until(lambda: only_run(plant).state == runs.CLOSED)
    finally:
        go_on.set()
        thread.stop()


def test_what_comes_late_while_a_run_is_being_closed_is_sorted_in(
    plant: Database, writer: SampleWriter, collector: Collector, monkeypatch: pytest.MonkeyPatch
) -> None:
    def late_meanwhile(session: Session, row: RunRow) -> RunContent:
        found = gather(session, row)
        monkeypatch.setattr(closing, "gather", gather)
        threading.Thread(target=lambda: send(writer, 50, 60)).start()
        wait_until(lambda: collector.late.may_wait(KEY.machine))
        return found

    send(writer, 0, 50)
    send(writer, 60, len(CYCLE))
    both = Closing(plant, collector)
    both.sort_in_late()  # nothing yet
    monkeypatch.setattr(closing, "gather", late_meanwhile)
    both.close_ended()
    assert (only_run(plant).state, only_run(plant).count) == (runs.CLOSED, 75)
    both.sort_in_late()
    assert (only_run(plant).state, only_run(plant).count) == (runs.CLOSED, 85)
    assert asked(plant) == [None, {"reopened": 1}]


def test_late_samples_wait_for_a_run_that_is_not_closed(plant: Database, writer: SampleWriter, collector: Collector) -> None:
    send(writer, 0, 50)
    send(writer, 60, len(CYCLE))
    send(writer, 50, 60)
    both = Closing(plant, collector)
    both.sort_in_late()
    assert (only_run(plant).state, only_run(plant).times_reopened) == (runs.ENDED, None)
    both.close_ended()
    both.sort_in_late()
    assert (only_run(plant).count, asked(plant)[0]) == (85, None)
