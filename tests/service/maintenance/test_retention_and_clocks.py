"""Clocks that are ahead while old samples are let go of: nothing goes that time has not made old, unless a person says so."""

import json
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import zenoh
from sqlalchemy import event, func, select
from typer.testing import CliRunner

from formats.wire import JSON, encode_body
from service.commands.app import app
from service.configuration.settings import Settings
from service.ingest.ingest_thread import Ingest
from service.maintenance import housekeeping
from service.maintenance.housekeeping import Housekeeping
from service.maintenance.retention_cut_offs import DAY_NS
from service.maintenance.retention_tiers import Blocks
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import runs
from storage.operation import audit, retention
from storage.tables.measurements import CollectorRow, RunRow, SampleBlockRow
from tests.api_in_process import Api
from tests.plant import KEY, SECOND, arrived, batch, machine, samples, wait_until

HOUR, YEAR = 3600 * SECOND, 365 * DAY_NS
MONTH = 30.0


class Clocks:
    """Error of the wall clock, and time served beyond what has passed [ns]."""

    wall = served = 0


@pytest.fixture(autouse=True)
def clocks(monkeypatch: pytest.MonkeyPatch) -> Clocks:
    one, wall, monotonic = Clocks(), time.time_ns, time.monotonic_ns
    monkeypatch.setattr(time, "time_ns", lambda: wall() + one.wall + one.served)
    monkeypatch.setattr(time, "monotonic_ns", lambda: monotonic() + one.served)
    monkeypatch.setattr(housekeeping, "PAUSE_S", 0.0)
    return one


class Led(WholeShare):
    """The share of a replica that leads, or does not."""

    leading = True

    def is_leader(self, work: str) -> bool:  # noqa: ARG002
        """Return what the test has set."""
        return self.leading


class AgedStore:
    """A machine whose source goes by the service's clock, and the service's housekeeping, which can be started anew."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.writer = SampleWriter(database, Collector())
        self.sequence = 0
        self.start()

    def start(self) -> None:
        """Start it, like a service after a restart."""
        settings = Settings(database=self.database.url, raw_days=MONTH, run_days=MONTH)
        self.housekeeping = Housekeeping(self.database, settings)

    def send(self, count: int, *, age: int = 0) -> None:
        """age: of the first sample [ns]."""
        one = batch([0.0] * count, sequence=self.sequence, start=time.time_ns() - age)
        self.writer.store([arrived(one, received_at=time.time_ns())], [])
        self.sequence += count

    def send_hours(self, hours: int) -> None:
        """A block of each of the last hours."""
        for hour in range(hours, 0, -1):
            self.send(10, age=hour * HOUR)

    @property
    def blocks(self) -> int:
        with self.database.reading() as session:
            return session.scalar(select(func.count()).select_from(SampleBlockRow)) or 0

    @property
    def waits(self) -> bool:
        """Return whether old samples are said to wait for a person, which warning and figure must agree on."""
        said = any("rundown retention confirm" in words for words in self.housekeeping.warnings)
        assert said == (self.housekeeping.gauges["rundown_retention_waiting"] == 1)
        return said


@pytest.fixture
def store(plant: Database) -> AgedStore:
    return AgedStore(plant)


def confirm(database: Database, monkeypatch: pytest.MonkeyPatch, *options: str, answer: str = "") -> tuple[int, str]:
    monkeypatch.setenv("RUNDOWN_DATABASE", database.url)
    monkeypatch.setenv("RUNDOWN_RAW_DAYS", str(MONTH))
    monkeypatch.setenv("RUNDOWN_RUN_DAYS", str(MONTH))
    ended = CliRunner().invoke(app, ["retention", "confirm", *options], input=answer)
    return ended.exit_code, ended.output


@pytest.mark.parametrize("restarted", [False, True])
def test_a_clock_a_year_ahead_lets_go_of_nothing(store: AgedStore, clocks: Clocks, restarted: bool) -> None:
    store.housekeeping.round()
    store.send_hours(12)
    clocks.wall = YEAR
    store.send(5)
    if restarted:
        store.start()
    for _ in range(3):
        store.housekeeping.round()
        clocks.served += HOUR
    assert store.blocks == 13
    assert store.waits
    clocks.wall = 0
    store.housekeeping.round()
    assert store.blocks == 13
    assert not store.waits


def test_a_store_of_an_older_release_whose_clock_is_ahead_loses_nothing(store: AgedStore, clocks: Clocks) -> None:
    store.send_hours(12)
    clocks.wall = YEAR
    store.send(5)
    for _ in range(3):
        store.housekeeping.round()
        clocks.served += 8 * HOUR
    assert store.blocks == 13
    assert store.waits


def test_the_clock_of_a_first_start_may_be_set_later(store: AgedStore, clocks: Clocks) -> None:
    """Before it knows the time a machine begins in 1970."""
    clocks.wall = -time.time_ns()
    store.housekeeping.round()
    clocks.served += HOUR
    store.housekeeping.round()
    clocks.wall = 0
    store.start()
    for _ in range(35):
        store.send(10)
        clocks.served += DAY_NS
        store.housekeeping.round()
        assert not store.waits
    assert store.blocks == 30


def test_a_machine_that_cannot_be_looked_at_keeps_no_other_from_its_cut_off(store: AgedStore) -> None:
    with store.database.transaction() as session:
        machines.create(session, machine(id="fan-2"))
    for number, age in enumerate((60, 0)):
        one = batch([0.0] * 5, machine="fan-2", sequence=5 * number, start=time.time_ns() - age * DAY_NS)
        store.writer.store([arrived(one, received_at=time.time_ns())], [])
    with store.database.transaction() as session:
        session.get_one(CollectorRow, "fan-2").state = {"revision": 1, "seen": "yesterday", "late": "never"}
    for day in range(45, 0, -1):
        store.send(10, age=day * DAY_NS)
    with pytest.raises(IndexError):
        store.housekeeping.round()
    assert store.waits
    with store.database.reading() as session:
        assert retention.cut_off(session, Blocks.name) is not None


def test_runs_are_kept_by_the_same_rule(store: AgedStore, clocks: Clocks) -> None:
    store.housekeeping.round()
    moment = time.time_ns()
    with store.database.transaction() as session:
        for number in range(retention.KEPT_RUNS + 5):
            begin = moment - (100 - number) * HOUR if number < retention.KEPT_RUNS + 4 else moment + YEAR
            row = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=begin)
            runs.close(row, samples=samples(30, start=begin), state=runs.CLOSED, reason="over")
    clocks.wall = YEAR
    store.housekeeping.round()
    with store.database.reading() as session:
        assert session.scalar(select(func.count()).where(RunRow.data.is_(None))) == 0
    assert store.waits


def test_samples_grow_old_as_time_passes(store: AgedStore, clocks: Clocks) -> None:
    """Nobody need confirm anything of a service that runs, is started anew, and is off for hours."""
    store.housekeeping.round()
    for day in range(1, 36):
        store.send(10)
        clocks.served += 23 * HOUR
        store.housekeeping.round()
        if day % 7 == 0:
            clocks.wall += 2 * HOUR
            store.start()
            store.housekeeping.round()
        assert not store.waits
    assert 28 <= store.blocks <= 32


def test_what_was_served_before_the_end_counts_after_a_start(store: AgedStore, clocks: Clocks) -> None:
    store.send(10)
    store.housekeeping.start()
    wait_until(lambda: store.housekeeping._counts)
    clocks.served += 5 * DAY_NS
    store.housekeeping.stop()
    with store.database.reading() as session:
        kept = retention.cut_off(session, Blocks.name)
    assert kept is not None
    assert kept[0] == pytest.approx(time.time_ns() - MONTH * DAY_NS, abs=10 * SECOND)


def test_what_waits_is_reported_by_the_replica_that_leads(
    store: AgedStore, clocks: Clocks, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And the time that another one leads is not counted by this one."""
    monkeypatch.setattr(housekeeping, "LOOK_S", 0.02)
    share = Led()
    store.send_hours(12)
    store.housekeeping.round()
    clocks.wall = YEAR
    store.send(5)
    one = Housekeeping(store.database, Settings(database=store.database.url, raw_days=MONTH), share)
    one.start()
    wait_until(lambda: one.gauges["rundown_retention_waiting"] == 1)
    share.leading = False
    wait_until(lambda: one.gauges["rundown_retention_waiting"] == 0)
    assert not any("rundown retention confirm" in words for words in one.warnings)
    clocks.served += 40 * DAY_NS
    time.sleep(0.1)
    share.leading = True
    one.stop()
    with store.database.reading() as session:
        kept = retention.cut_off(session, Blocks.name)
    assert kept is not None
    assert kept[0] < time.time_ns() - YEAR - 69 * DAY_NS
    assert store.blocks == 13


def test_a_service_that_was_off_for_a_month_waits_for_a_person(
    store: AgedStore, clocks: Clocks, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And it goes on letting go of what grows old as time passes, so that the store does not grow meanwhile."""
    with store.database.transaction() as session:
        machines.create(session, machine(id="fan-2"))
    store.housekeeping.round()
    for _ in range(10):
        store.send(10)
        clocks.served += DAY_NS
        store.housekeeping.round()
    clocks.wall += round(MONTH * DAY_NS)
    store.start()
    store.send(10)
    store.housekeeping.round()
    assert store.blocks == 11
    assert store.waits
    status, said = confirm(store.database, monkeypatch, answer="n\n")
    assert status == 1
    assert "pump-7" in said
    assert "       10  from" in said
    assert "fan-2" not in said
    store.housekeeping.round()
    assert store.blocks == 11
    status, said = confirm(store.database, monkeypatch, "--yes")
    assert (status, "confirmed" in said) == (0, True)
    store.housekeeping.round()
    assert store.blocks == 1
    assert not store.waits
    with store.database.reading() as session:
        told = [row for row in audit.newest(session, limit=10) if row.operation == "confirm_retention"]
        assert [row.who for row in told] == ["rundown retention"] * 2
        assert audit.verify(session) == []


def test_what_is_asked_for_the_first_time_is_shown_before_it_is_done(
    store: AgedStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    for day in range(60, 0, -1):
        store.send(10, age=day * DAY_NS)
    store.housekeeping.round()
    assert store.blocks == 60
    assert store.waits
    assert confirm(store.database, monkeypatch, "--yes")[0] == 0
    store.housekeeping.round()
    assert store.blocks == 30


def test_a_program_confirms_only_with_yes(store: AgedStore, clocks: Clocks, monkeypatch: pytest.MonkeyPatch) -> None:
    store.housekeeping.round()
    store.send_hours(2)
    clocks.wall = YEAR
    store.send(1)
    store.housekeeping.round()
    status, said = confirm(store.database, monkeypatch, "--json", answer="y\n")
    assert status == 1
    assert "say --yes beside it" in said
    assert "tiers" not in said
    status, said = confirm(store.database, monkeypatch, "--json", "--yes")
    assert status == 0
    raw = next(one for one in json.loads(said)["tiers"] if one["machines"])
    (extent,) = raw["machines"].values()
    assert (raw["kept_days"], extent["count"]) == (MONTH, 2)
    assert extent["first"] < extent["last"]


def test_nothing_can_be_confirmed_where_nothing_is_let_go_of(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RUNDOWN_DATABASE", plant.url)
    ended = CliRunner().invoke(app, ["retention", "confirm"])
    assert ended.exit_code == 1
    assert "neither raw_days nor run_days is set" in ended.output


@pytest.fixture
def http(router: zenoh.Session, plant: Database) -> Iterator[Api]:
    """The application with its ingest."""
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(plant, Collector()), silence_s=600.0, submissions=submissions)
    ingest.start()
    yield Api(plant, submissions=submissions)
    ingest.stop()


def test_a_disk_that_is_full_while_samples_wait_costs_none(
    store: AgedStore, clocks: Clocks, http: Api, tmp_path: Path
) -> None:
    """Nothing unconfirmed is let go of to make room; who sends is told, and goes on where there is room again."""
    if store.database.kind != "sqlite":
        pytest.skip("a server's disk cannot be filled")
    store.housekeeping.round()
    store.send_hours(12)
    clocks.wall = YEAR
    store.send(5)
    engine = store.database.engine
    pages = (tmp_path / "rundown.db").stat().st_size // 4096

    def fill(connection: object, _record: object) -> None:
        connection.execute(f"PRAGMA max_page_count = {pages}")  # type: ignore[attr-defined]

    def post(sequence: int) -> int:
        body = encode_body(batch([0.0] * 5000, sequence=sequence, start=time.time_ns() - HOUR, step=1000, source="http"), JSON)
        path = f"/api/v1/machines/{KEY.machine}/samples"
        return http.ask("POST", path, content=body, headers={"content-type": JSON}).status_code

    engine.dispose()
    event.listen(engine, "connect", fill)
    sequence = 0
    while post(sequence) == 200:
        sequence += 5000
    store.housekeeping.round()
    assert store.waits
    assert store.blocks >= 13
    before = store.blocks
    assert post(sequence) == 503
    event.remove(engine, "connect", fill)
    engine.dispose()
    deadline = time.monotonic() + 30
    while post(sequence) != 200:
        assert time.monotonic() < deadline
        time.sleep(0.2)
    assert store.blocks > before
