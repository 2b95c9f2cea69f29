"""Pages of the store are damaged: it is told until a check is clean, whose data they are, and the other machines go on."""

import logging
import shutil
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
import zenoh
from sqlalchemy import text
from sqlalchemy.exc import DBAPIError

from formats.wire import JSON, encode_body
from service.configuration.settings import Settings
from service.identification.scheduler import JobScheduler
from service.ingest.ingest_thread import Ingest
from service.maintenance.housekeeping import Housekeeping
from service.maintenance.retention_tiers import Tier
from service.maintenance.store_check import StoreCheck
from service.runs.collector import Collector
from service.write_path.http_queue import Submissions
from service.write_path.sample_writer import SampleWriter
from storage.database import file_inspection
from storage.database.damage import is_damage, marker_of
from storage.database.engine import Database
from storage.findings import jobs
from storage.machines import machines, timeline
from storage.measurements import quarantine, runs
from storage.tables.measurements import CollectorRow
from tests.api_in_process import PREFIX, Api, problem
from tests.conftest import Stores
from tests.damage import damage
from tests.identification import counts
from tests.plant import KEY, START, batch, machine, samples, sqlite_url, wait_until

HURT = "fan-2"
"""The machine whose pages are damaged; the other one is that of `tests.plant`."""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A store with two machines, of one of which a page of the timeline is damaged, and where its collection stands."""
    found = tmp_path / "rundown.db"
    with closing(Database(sqlite_url(found))) as database, database.transaction() as session:
        for name in (HURT, KEY.machine):
            machines.create(session, machine(id=name))
        for number in range(40):
            timeline.add(session, HURT, at=START + number, kind="note", text="timeline of the fan " * 90, by="anna")
        for number in range(40):
            timeline.add(session, KEY.machine, at=START + number, kind="note", text="of the pump " * 90, by="anna")
        for name in (HURT, KEY.machine):
            run = runs.open_run(session, name, revision=1, kind="run-down", direction=1, time_first=START)
            runs.close(run, samples=samples(40), state=runs.CLOSED, reason="the speed left the speed range")
            jobs.enqueue(session, name, scope=jobs.RUN, run_ids=[run.id])
            if name == HURT:
                run.data = b"samples of the fan " * 2_000
        session.add(CollectorRow(machine_id=HURT, state={"filler": "collection of the fan " * 2_000}))
    shutil.copy(found, tmp_path / "whole")
    damage(found, b"timeline of the fan")
    damage(found, b"collection of the fan")
    damage(found, b"samples of the fan")
    return found


@pytest.fixture
def database(path: Path) -> Iterator[Database]:
    """The damaged store, open."""
    one = Database(sqlite_url(path))
    yield one
    one.close()


def metric(api: Api, name: str) -> float:
    """One figure of the metrics."""
    lines = api.ask("GET", "/metrics").text.splitlines()
    return float(next(line for line in lines if line.startswith(name + " ")).split()[1])


def test_who_meets_it_is_told_and_the_others_go_on(database: Database, path: Path, caplog: pytest.LogCaptureFixture) -> None:
    api = Api(database)
    assert api.value("/health")["parts"]["database"] == "ok"
    with caplog.at_level(logging.ERROR):
        for _ in range(5):
            assert "is damaged" in problem(api.get(f"/machines/{HURT}/timeline"), 503)["detail"]
    assert sum("the store is damaged" in one.message for one in caplog.records) == 1
    assert len(api.value(f"/machines/{KEY.machine}/timeline", limit=40)) == 40
    health = api.get("/health")
    assert health.status_code == 503
    words = health.json()["parts"]["database"]
    assert f"damaged, of {HURT}: database disk image is malformed" in words
    assert "restore a backup" in words
    ready = api.get("/ready")
    assert (ready.status_code, ready.json()["ready"], ready.json()["healthy"]) == (200, True, False)
    assert ready.json()["parts"]["database"] == words
    assert (metric(api, "rundown_store_damaged"), metric(api, "rundown_database_answers")) == (1, 1)
    assert marker_of(path).exists()


def test_it_is_reported_until_a_check_is_clean_also_behind_a_restart(path: Path, tmp_path: Path) -> None:
    with closing(Database(sqlite_url(path))) as database:
        assert Api(database).get(f"/machines/{HURT}/timeline").status_code == 503
        met = database.damage.trouble
    with closing(Database(sqlite_url(path))) as database:
        assert database.damage.trouble == met
        database.check_integrity(within_s=20.0, stopped=lambda: False)
        assert database.damage.trouble is not None
        assert "btreeInitPage" in database.damage.trouble or "Tree" in database.damage.trouble
    path.write_bytes((tmp_path / "whole").read_bytes())
    with closing(Database(sqlite_url(path))) as database:
        assert database.damage.trouble is not None
        watch = StoreCheck(database)
        watch.start()
        try:
            wait_until(lambda: database.damage.trouble is None, seconds=10.0)
        finally:
            watch.stop()
    assert not marker_of(path).exists()


def test_samples_of_the_others_are_stored(database: Database, router: zenoh.Session) -> None:
    submissions = Submissions()
    ingest = Ingest(router, SampleWriter(database, Collector()), silence_s=60.0, submissions=submissions)
    ingest.start()
    api = Api(database, submissions=submissions)

    def send(name: str, number: int) -> int:
        body = encode_body(batch(sequence=number, start=START + number * 10**9, machine=name), JSON)
        return api.ask("POST", f"{PREFIX}/machines/{name}/samples", content=body, headers={"content-type": JSON}).status_code

    try:
        for number in range(3):
            assert send(HURT, number) == 503
            assert send(KEY.machine, number) == 200
        assert ingest.trouble is None
        assert api.get("/ready").status_code == 200
    finally:
        ingest.stop()
    with database.reading() as session:
        assert "undecodable" not in quarantine.counts(session)
    assert database.damage.trouble is not None
    assert HURT in database.damage.trouble


def test_jobs_of_the_others_are_taken(database: Database) -> None:
    identifying = JobScheduler(database, Settings(workers=1))
    identifying.start()
    try:
        wait_until(lambda: not counts(database).keys() & {jobs.QUEUED, jobs.RUNNING})
        assert identifying.trouble is None
    finally:
        identifying.stop()
    with database.reading() as session:
        (hurt,), (other,) = (jobs.of_machine(session, name, limit=9) for name in (HURT, KEY.machine))
    assert (hurt.state, hurt.error) == (jobs.FAILED, "its data cannot be read: database disk image is malformed")
    assert "malformed" not in (other.error or "")
    assert HURT in (database.damage.trouble or "")


def test_housekeeping_passes_over_it(database: Database) -> None:
    housekeeping = Housekeeping(database, Settings(raw_days=1.0, run_days=1.0))
    seen: list[str] = []
    release = housekeeping._release

    def noted(tier: Tier, machine_id: str, moment: int) -> bool:
        seen.append(machine_id)
        if machine_id == HURT:
            with database.reading() as session:
                timeline.of_machine(session, HURT, limit=40)
        return release(tier, machine_id, moment)

    housekeeping._release = noted  # type: ignore[method-assign]
    with pytest.raises(DBAPIError, match="malformed"):
        housekeeping.round()
    assert list(dict.fromkeys(seen)) == [HURT, KEY.machine]


@pytest.mark.parametrize("code", ["XX001", "XX002"])
def test_what_postgresql_says_of_damage_is_heard(stores: Stores, tmp_path: Path, code: str) -> None:
    database = Database(stores.databases("postgresql").copy(stores.empty("postgresql"), tmp_path / "damaged"))
    raising = text(f"DO $$ BEGIN RAISE EXCEPTION 'invalid page in block 7' USING ERRCODE = '{code}'; END $$")
    with pytest.raises(DBAPIError) as caught, database.reading() as session:
        session.execute(raising)
    assert is_damage(caught.value)
    assert database.damage.trouble is not None
    assert "invalid page in block 7" in database.damage.trouble
    database.check_integrity(within_s=1.0, stopped=lambda: False)
    assert database.damage.trouble is not None
    database.close()


def test_a_check_that_is_not_at_its_end_clears_nothing(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(file_inspection, "_STEPS", 1)
    database.damage.record_findings(["something"])
    database.check_integrity(within_s=0.0, stopped=lambda: False)
    database.check_integrity(within_s=20.0, stopped=lambda: True)
    assert database.damage.trouble is not None
    assert "something" in database.damage.trouble


def test_a_text_that_is_none_is_damage_and_not_shown(database: Database) -> None:
    with database.transaction() as session:
        session.execute(text("UPDATE timeline SET text = CAST(x'73656372657473ff' AS TEXT) WHERE machine_id = 'pump-7'"))
    api = Api(database)
    detail = problem(api.get(f"/machines/{KEY.machine}/timeline"), 503)["detail"]
    words = api.get("/health").json()["parts"]["database"]
    assert "Could not decode to UTF-8 column 'text'" in detail
    assert f"of {KEY.machine}: Could not decode to UTF-8 column 'text' (first met" in words
    assert "secrets" not in detail + words


def test_a_document_that_is_none_is_damage(database: Database) -> None:
    with database.transaction() as session:
        session.execute(text("UPDATE machine_revisions SET document = 'secrets' WHERE machine_id = 'pump-7'"))
    api = Api(database)
    listed = {one["id"]: one["name"] for one in api.value("/machines")}
    assert listed == {HURT: machine().name, KEY.machine: ""}
    words = api.get("/health").json()["parts"]["database"]
    assert f"of {KEY.machine}: malformed JSON (first met" in words
    assert [one["id"] for one in api.value("/fleet")["machines"]] == [HURT, KEY.machine]
    assert "damaged" in problem(api.get(f"/machines/{KEY.machine}"), 503)["detail"]
    assert api.value(f"/machines/{HURT}")["id"] == HURT
    assert "secrets" not in words


def test_what_is_no_damage_is_none(database: Database) -> None:
    with pytest.raises(DBAPIError), database.reading() as session:
        session.execute(text("SELECT * FROM nowhere"))
    assert database.damage.trouble is None
