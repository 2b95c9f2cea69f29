"""Retention: what is old enough is let go of and nothing that is needed; and what is said of the room on the disk."""

import time
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError
from sqlalchemy import select, text

from service.configuration.settings import Settings
from service.identification.task_builder import _earlier
from service.maintenance import housekeeping, retention_tiers
from service.maintenance.disk_watch import warning
from service.maintenance.housekeeping import Housekeeping
from service.maintenance.retention_cut_offs import DAY_NS
from service.maintenance.retention_tiers import Blocks, Runs, tiers_of
from service.replication.work_share import WholeShare
from service.runs.collector import Collector
from storage.database import disk
from storage.database.disk import DiskUse
from storage.database.engine import Database
from storage.findings import identifications, jobs
from storage.machines import baselines, machines
from storage.measurements import runs
from storage.operation import retention
from storage.tables.measurements import CollectorRow, RunRow, SampleBlockRow
from tests.api_in_process import Api, problem
from tests.conftest import Stores
from tests.databases import Kind
from tests.plant import (
    KEY,
    SECOND,
    START,
    arrived,
    batch,
    identification,
    machine,
    samples,
    store_identification,
    sweep_rpm,
    wait_until,
)
from tests.prompt_writer import PromptWriter

DAYS = 60


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(housekeeping, "PAUSE_S", 0.0)


def kept(database: Database, **settings: Any) -> Housekeeping:
    """A round of a service whose clock and settings were confirmed."""
    one = Housekeeping(database, confirmed(database, **settings))
    one.round()
    return one


def confirmed(database: Database, **settings: Any) -> Settings:
    """Settings, whose cut-offs by the present clock were confirmed."""
    given = Settings(database=database.url, **settings)
    with database.transaction() as session:
        for tier in tiers_of(given):
            retention.store_cut_off(session, tier.name, time=time.time_ns() - tier.kept, allowance=DAY_NS)
    return given


def feed(writer: PromptWriter, first_day: int, last_day: int) -> None:
    """Ten samples at standstill each day."""
    for day in range(first_day, last_day):
        one = batch([0.0] * 10, sequence=10 * day, start=START + day * DAY_NS)
        writer.store([arrived(one, received_at=START + 400 * DAY_NS)], [])


def days(database: Database) -> list[int]:
    with database.reading() as session:
        times = session.scalars(select(SampleBlockRow.time_first).order_by(SampleBlockRow.time_first)).all()
    return [(time - START) // DAY_NS for time in times]


def add_runs(database: Database, count: int) -> list[int]:
    """A closed run a day."""
    made = []
    with database.transaction() as session:
        for day in range(count):
            row = runs.open_run(
                session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START + day * DAY_NS
            )
            runs.close(row, samples=samples(30, start=START + day * DAY_NS), state=runs.CLOSED, reason="over")
            made.append(row.id)
    return made


def with_samples(database: Database) -> list[int]:
    with database.reading() as session:
        return list(session.scalars(select(RunRow.id).where(RunRow.data.is_not(None)).order_by(RunRow.id)))


# --- blocks ---------------------------------------------------------------------------------------------------------


def test_nothing_is_let_go_of_unless_asked_for(plant: Database, writer: PromptWriter) -> None:
    feed(writer, 0, DAYS)
    made = add_runs(plant, DAYS)
    kept(plant)
    assert days(plant) == list(range(DAYS))
    assert with_samples(plant) == made


def test_old_blocks_go_in_small_transactions(plant: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retention_tiers, "BLOCKS", 7)
    feed(writer, 0, DAYS)
    done = kept(plant, raw_days=30)
    assert days(plant) == list(range(DAYS - 31, DAYS))
    assert done.released[Blocks.name] == DAYS - 31
    with plant.reading() as session:
        assert machines.get(session, KEY.machine).blocks_since == START + (DAYS - 32) * DAY_NS + 9 * SECOND + 1


def test_a_machine_that_cannot_be_looked_after_keeps_no_other_from_it(plant: Database, writer: PromptWriter) -> None:
    with plant.transaction() as session:
        machines.create(session, machine(id="a-fan"))
    for day in (0, DAYS):
        one = batch([0.0] * 10, machine="a-fan", sequence=day, start=START + day * DAY_NS)
        writer.store([arrived(one, received_at=START + 400 * DAY_NS)], [])
    feed(writer, 0, DAYS)
    with plant.transaction() as session:
        session.get_one(CollectorRow, "a-fan").state = {"revision": 1, "seen": "yesterday", "late": "never"}
    keeping = Housekeeping(plant, confirmed(plant, raw_days=30))
    with pytest.raises(IndexError):
        keeping.round()
    assert keeping.released[Blocks.name] == DAYS - 31


def test_a_machine_that_was_off_loses_nothing(plant: Database, writer: PromptWriter) -> None:
    """Its newest sample is years old."""
    feed(writer, 0, 20)
    kept(plant, raw_days=30)
    assert days(plant) == list(range(20))


def test_the_blocks_of_an_open_run_are_kept(plant: Database, writer: PromptWriter) -> None:
    feed(writer, 0, 10)
    with plant.transaction() as session:
        runs.open_run(session, KEY.machine, revision=1, kind="run-up", direction=1, time_first=START + 4 * DAY_NS)
    feed(writer, 10, DAYS)
    kept(plant, raw_days=1)
    assert days(plant) == list(range(4, DAYS))


def test_the_blocks_that_late_samples_wait_for_are_kept(plant: Database, writer: PromptWriter) -> None:
    feed(writer, 5, DAYS)
    feed(writer, 3, 4)
    kept(plant, raw_days=1)
    assert days(plant) == [3, *range(5, DAYS)]


def test_the_blocks_in_speed_bins_are_kept(plant: Database) -> None:
    rules = {"interval_s": 10**7, "coverage": 0.9, "recency_s": 10**7}
    with plant.transaction() as session:
        machines.revise(session, machine(collection={"runs": "rolling", "rolling": rules}))
    writer = PromptWriter(plant, Collector())
    for day in range(10):
        one = batch([900.0 + 10 * day] * 10, sequence=10 * day, start=START + day * DAY_NS)
        writer.store([arrived(one, received_at=START + 400 * DAY_NS)], [])
    kept(plant, raw_days=1)
    assert days(plant)[0] <= 1


def test_late_samples_do_not_spoil_a_run_whose_blocks_are_gone(plant: Database) -> None:
    sweep = sweep_rpm(2900.0, 400.0, 60)
    writer = PromptWriter(plant, Collector(late_s=0.0))

    def send(first: int, last: int) -> None:
        one = batch(sweep[first:last], sequence=first, start=START + first * SECOND)
        writer.store([arrived(one)], [])

    send(0, 30)
    send(35, 60)
    writer.settle(silence_s=0.0)
    with plant.reading() as session:
        (before,) = runs.of_machine(session, KEY.machine)
        assert before.count == 55
    with plant.transaction() as session:
        assert retention.release_blocks(session, KEY.machine, before=START + DAY_NS, limit=10) == 2
    send(30, 35)
    writer.settle(silence_s=0.0)
    with plant.reading() as session:
        (after,) = runs.of_machine(session, KEY.machine)
        assert (after.count, after.reopened_at) == (55, None)
        assert after.coverage is not None
        assert after.coverage[runs.LEFT_OUT] == 5


# --- runs -----------------------------------------------------------------------------------------------------------


def test_old_runs_lose_their_samples_and_nothing_else(plant: Database) -> None:
    made = add_runs(plant, DAYS)
    api = Api(plant)
    before = api.value(f"/runs/{made[0]}")
    done = kept(plant, run_days=30)
    assert with_samples(plant) == made[DAYS - 31 :]
    assert done.released[Runs.name] == DAYS - 31
    after = api.value(f"/runs/{made[0]}")
    assert after.pop("samples_released_at") is not None
    assert before.pop("samples_released_at") is None
    assert after == before
    problem(api.get(f"/runs/{made[0]}/phasors"), 410)
    problem(api.get(f"/runs/{made[0]}/quality"), 410)
    problem(api.get(f"/runs/{made[0]}/orbits", rpm=1000), 410)
    assert api.get(f"/runs/{made[-1]}/phasors").status_code == 200


def test_the_newest_runs_keep_their_samples(plant: Database) -> None:
    made = add_runs(plant, DAYS)
    kept(plant, run_days=1)
    assert with_samples(plant) == made[-retention.KEPT_RUNS :]


def test_runs_that_wait_for_an_identification_keep_theirs(plant: Database) -> None:
    made = add_runs(plant, DAYS)
    with plant.transaction() as session:
        jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[made[3]])
        gathered = jobs.enqueue(session, KEY.machine, scope=jobs.GATHERED, run_ids=[made[5], made[6]])
        assert gathered is not None
        gathered.state = jobs.RUNNING
        over = jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[made[7]])
        assert over is not None
        jobs.finish(over, state=jobs.DONE)
    kept(plant, run_days=1)
    assert with_samples(plant) == [made[3], made[5], made[6], *made[-retention.KEPT_RUNS :]]


def test_runs_of_baselines_keep_theirs(plant: Database) -> None:
    """The machine's first accepted runs, those named by a person, and the first behind a maintenance."""
    made = add_runs(plant, DAYS)
    with plant.transaction() as session:
        found = [
            store_identification(session, identification(accepted=day != 1), run_id=run, measured_at=START + day * DAY_NS).id
            for day, run in enumerate(made[:30])
        ]
        named = [found[10], found[12]]
        baselines.begin(session, KEY.machine, since=START, identification_ids=named, reason="", by="anna")
        since = START + 20 * DAY_NS
        baselines.begin(session, KEY.machine, since=since, identification_ids=None, reason="overhaul", by="anna")
    kept(plant, run_days=1, baseline_runs=3)
    expected = [0, 2, 3, 10, 12, 20, 21, 22]
    assert with_samples(plant) == [*(made[day] for day in expected), *made[-retention.KEPT_RUNS :]]


def test_identifications_stay(plant: Database) -> None:
    made = add_runs(plant, DAYS)
    with plant.transaction() as session:
        for number, run in enumerate(made):
            store_identification(session, identification(), run_id=run, measured_at=START + number * DAY_NS)
    kept(plant, run_days=1)
    with plant.reading() as session:
        assert all(identifications.estimates(session, number + 1) for number in range(DAYS))
    api = Api(plant)
    assert api.get("/identifications/20/model/critical-speeds").status_code == 200
    assert api.get("/identifications/20/bode").status_code == 200
    answer = api.ask("POST", f"/api/v1/runs/{made[19]}/identifications", json={"starts": 3})
    assert "no longer has its samples" in problem(answer, 409)["detail"]


def test_a_released_run_is_no_reason_to_fail_for_the_next(plant: Database) -> None:
    """The run before is compared with for its quality."""
    made = add_runs(plant, 2)
    with plant.transaction() as session:
        session.execute(text("UPDATE runs SET data = NULL, released_at = 1 WHERE id = 1"))
        job = jobs.enqueue(session, KEY.machine, scope=jobs.RUN, run_ids=[made[1]])
        assert job is not None
        assert _earlier(session, job) is None


def test_nobody_waits_for_a_round_that_lets_go_of_nothing(
    plant: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("storage.database.writer_turn.BUSY_TIMEOUT_MS", 100)
    feed(writer, 0, 20)
    add_runs(plant, 25)
    one = Housekeeping(plant, confirmed(plant, raw_days=30, run_days=1))
    one.round()
    with plant.transaction():  # another round would have to wait for its turn to write
        one.round()
    assert (one.released[Blocks.name], one.released[Runs.name]) == (0, 5)


@pytest.mark.parametrize("name", ["raw_days", "run_days"])
def test_less_than_a_day_is_refused(name: str) -> None:
    half_a_day: dict[str, Any] = {name: 0.5}
    with pytest.raises(ValidationError, match="is less than a day"):
        Settings(**half_a_day)


# --- room -----------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_room_is_given_back_to_the_file_system(plant: Database, writer: PromptWriter, tmp_path: Path) -> None:
    made = add_runs(plant, DAYS)
    noise = samples(5000).phasor.tobytes() * 5
    with plant.transaction() as session:
        session.execute(text("UPDATE runs SET data = :data WHERE id <= 30"), {"data": noise})
    feed(writer, 0, 2)
    with plant.transaction():
        pass
    before = disk.used(plant, budget=None).data
    kept(plant, run_days=30)
    assert with_samples(plant) == made[DAYS - 31 :]
    if plant.kind == "sqlite":
        with plant.engine.connect() as connection:
            connection.exec_driver_sql("PRAGMA wal_checkpoint(TRUNCATE)")
            assert connection.exec_driver_sql("PRAGMA freelist_count").scalar() == 0
        assert (tmp_path / "rundown.db").stat().st_size < before / 2
    else:
        assert before > 8_000_000


def test_the_room_is_shown_and_warned_of(plant: Database, caplog: pytest.LogCaptureFixture) -> None:
    one = Housekeeping(plant, Settings(database=plant.url, disk_budget_gb=0.0001))
    api = Api(plant, warnings=lambda: one.warnings, gauges=lambda: one.gauges)
    one.check_disk()
    (said,) = [words for words in api.value("/health")["warnings"] if words.startswith("the store is")]
    assert "nearly full" in said
    assert "of 0.0 GB that it may take" in said
    assert said in caplog.text
    figures = dict(line.split() for line in api.ask("GET", "/metrics").text.splitlines() if line.startswith("rundown_disk"))
    assert float(figures["rundown_disk_used_ratio"]) > 1.0
    assert float(figures["rundown_disk_budget_bytes"]) == 100_000


@pytest.mark.parametrize(
    ("use", "said"),
    [
        (DiskUse(79, None, None, 100), ""),
        (DiskUse(80, None, None, 100), "filling: 80 %"),
        (DiskUse(96, 10**9, 2 * 10**9, 100), "nearly full"),
        (DiskUse(10, 19, 100, 10**9), "filling: 81 %"),
        (DiskUse(10, 4, 100, None), "nearly full: samples will soon not be stored: 96 %"),
        (DiskUse(10, None, None, None), ""),
    ],
)
def test_warnings_come_well_before_the_end(use: DiskUse, said: str) -> None:
    assert said in warning(use)
    assert bool(said) == bool(warning(use))


def test_the_room_is_looked_at_during_a_long_round(
    plant: Database, writer: PromptWriter, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(housekeeping, "LOOK_S", 0.0)
    feed(writer, 0, DAYS)
    one = Housekeeping(plant, confirmed(plant, disk_budget_gb=0.0001, raw_days=30))
    one.round()
    assert "nearly full" in one.warnings[0]


def test_it_runs_in_the_background_and_ends_when_told(plant: Database, writer: PromptWriter) -> None:
    feed(writer, 0, DAYS)
    one = Housekeeping(plant, confirmed(plant, raw_days=30))
    one.start()
    wait_until(lambda: one.released[Blocks.name] == DAYS - 31 or one.unfinished is not None, seconds=30)
    assert one.unfinished is None
    assert one.alive
    one.stop()
    assert not one.alive


def test_a_round_that_fails_is_reported_until_one_does_not(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks at the disk in between, which succeed, say nothing of retention."""
    monkeypatch.setattr(housekeeping, "LOOK_S", 0.02)
    monkeypatch.setattr(housekeeping, "INTERVAL_S", 1.0)
    one = Housekeeping(plant, confirmed(plant, raw_days=30))
    api = Api(plant, warnings=lambda: one.warnings, gauges=lambda: one.gauges)
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE machines RENAME TO machines_elsewhere"))
    one.start()
    wait_until(lambda: one.unfinished is not None, seconds=30)
    began = time.monotonic()
    while time.monotonic() < began + 0.5:
        assert one.gauges["rundown_housekeeping_working"] == 0
        time.sleep(0.005)
    assert one.unseen is None
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE machines_elsewhere RENAME TO machines"))
    assert any(words.startswith("old samples are not deleted") for words in api.value("/health")["warnings"])
    wait_until(lambda: one.unfinished is None, seconds=30)
    assert one.gauges["rundown_housekeeping_working"] == 1
    one.stop()


class _Elsewhere(WholeShare):
    """The share of a replica that does what one does for all at first, and then another one does it."""

    leading = True

    def is_leader(self, work: str) -> bool:  # noqa: ARG002
        """Return what the test has set."""
        return self.leading


def test_what_hindered_it_is_forgotten_where_another_replica_does_it(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(housekeeping, "LOOK_S", 0.02)
    share = _Elsewhere()
    one = Housekeeping(plant, confirmed(plant, raw_days=30), share)
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE machines RENAME TO machines_elsewhere"))
    one.start()
    wait_until(lambda: one.unfinished is not None, seconds=30)
    share.leading = False
    wait_until(lambda: one.unfinished is None, seconds=30)
    one.stop()
    with plant.transaction() as session:
        session.execute(text("ALTER TABLE machines_elsewhere RENAME TO machines"))


def test_what_cannot_be_looked_at_is_told_apart_from_retention(
    plant: Database, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if plant.kind != "sqlite":
        pytest.skip("a server's disk is not looked at")
    monkeypatch.setattr(housekeeping, "LOOK_S", 0.02)
    one = Housekeeping(plant, confirmed(plant, raw_days=30))
    one.start()
    wait_until(lambda: "rundown_disk_used_ratio" in one.gauges, seconds=30)
    away = tmp_path.rename(tmp_path.with_name("away"))
    wait_until(lambda: one.unseen is not None, seconds=30)
    assert one.gauges["rundown_housekeeping_working"] == 0
    assert "the free disk space is unknown: RuntimeError: the disk cannot be read" in one.warnings[0]
    assert "rundown_disk_used_ratio" not in one.gauges
    away.rename(tmp_path)
    wait_until(lambda: one.unseen is None, seconds=30)
    assert one.gauges["rundown_housekeeping_working"] == 1
    one.stop()


def test_no_part_is_shown_of_room_that_is_not_known(stores: Stores, tmp_path: Path) -> None:
    """A ratio of 0 would be an alarm that cannot fire."""
    cases: list[tuple[Kind, float, bool]] = [("postgresql", 0.0, False), ("postgresql", 50.0, True), ("sqlite", 0.0, True)]
    for kind, budget, shown in cases:
        url = stores.databases(kind).copy(stores.empty(kind), tmp_path / "rundown.db")
        with closing(Database(url)) as database:
            one = Housekeeping(database, Settings(database=url, disk_budget_gb=budget))
            one.check_disk()
            assert ("rundown_disk_used_ratio" in one.gauges) == shown, (kind, budget)
            assert one.gauges["rundown_database_bytes"] > 0
