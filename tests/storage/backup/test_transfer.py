"""All data taken over from a database of either kind to one of either kind."""

import math
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import JSON, Float, create_engine, delete, insert, inspect, select, text, update
from sqlalchemy.exc import IntegrityError

from storage.backup.transfer import TransferFailed, move
from storage.database.claim import DatabaseUnusable
from storage.database.engine import Database
from storage.encoding.text import nul_unescaped
from storage.machines import machines
from storage.measurements import quarantine
from storage.measurements.quarantine import Rejection
from storage.operation import audit, replicas
from storage.tables.alerting import AlertRow
from storage.tables.machines import TimelineRow
from storage.tables.measurements import QuarantineRow, RunRow
from storage.tables.operation import AuditHeadRow, AuditRow
from tests.conftest import Stores
from tests.databases import KINDS, Databases, Kind
from tests.plant import START, identification, machine, sqlite_url, store_identification
from tests.postgresql import connection
from tests.storage.database.test_migrations import ROWS, TABLES, value


@pytest.fixture(params=KINDS)
def target_kind(request: pytest.FixtureRequest) -> Kind:
    """Return to which kind of database data are taken over."""
    found: Kind = request.param
    return found


@pytest.fixture
def unmade_target(target_kind: Kind, stores: Stores, tmp_path: Path) -> Iterator[str]:
    """URL of a database that holds nothing, not even a schema."""
    there = stores.databases(target_kind)
    url = there.new(tmp_path / f"moved_{tmp_path.name}.db")
    yield url
    there.drop(url)


@pytest.fixture
def target(target_kind: Kind, stores: Stores, tmp_path: Path) -> Iterator[str]:
    """URL of a database that holds its schema and no data: to make it anew takes longer than most tests."""
    there = stores.databases(target_kind)
    url = there.copy(stores.empty(target_kind), tmp_path / f"moved_{tmp_path.name}.db")
    yield url
    there.drop(url)


@pytest.fixture
def full(database: Database) -> Database:
    """Rows in every table, with all that kinds of databases may differ in."""
    with database.transaction() as session:
        for table in TABLES:
            for row in range(1, ROWS + 1):
                session.execute(insert(table).values({column.name: value(column, row) for column in table.columns}))
        session.execute(update(RunRow).where(RunRow.id == 1).values(coverage=None, speed_minimum=1e308, speed_maximum=5e-324))
        session.execute(text("UPDATE runs SET coverage = NULL, quality = 'null', data = NULL WHERE id = 2"))
        session.execute(update(AlertRow).where(AlertRow.id == 1).values(evidence={"deep": [{"ö": [1.1, True, None]}]}))
    return database


def contents(url: str) -> dict[str, list[Any]]:
    database = Database(url)
    found: dict[str, list[Any]] = {}
    with database.reading() as session:
        for table in TABLES:
            nulls = [column.is_(None) for column in table.columns if isinstance(column.type, JSON)]
            rows = session.execute(select(*table.columns, *nulls).order_by(*table.primary_key.columns))
            found[table.name] = [tuple(map(repr, row)) for row in rows]
    database.close()
    return found


def test_every_table_is_taken_over(full: Database, unmade_target: str) -> None:
    expected = contents(full.url)
    assert move(full.url, unmade_target).rows == dict.fromkeys((table.name for table in TABLES), ROWS)
    found = contents(unmade_target)
    for name, rows in expected.items():
        # SQLite keeps a truth as a number, which is shown as one only where it is the answer to a question.
        assert [[_truth(one) for one in row] for row in found[name]] == [[_truth(one) for one in row] for row in rows], name
    full.check()


def _truth(shown: str) -> str:
    return {"True": "1", "False": "0"}.get(shown, shown)


def test_numbers_go_on_behind_those_taken_over(plant: Database, target: str) -> None:
    with plant.transaction() as session:
        store_identification(session, identification(), run_id=1)
        for _ in range(3):
            quarantine.add(session, [Rejection(START, "key", None, "bad_frame", "detail", b"")])
    move(plant.url, target)
    moved = Database(target)
    with moved.transaction() as session:
        quarantine.add(session, [Rejection(START, "key", None, "bad_frame", "detail", b"")])
        assert store_identification(session, identification(), run_id=2).id == 2
    with moved.reading() as session:
        assert session.scalars(select(QuarantineRow.id).order_by(QuarantineRow.id)).all() == [1, 2, 3, 4]
    moved.close()


def join(url: str) -> int:
    """The number of a new replica, which is gone again at once."""
    database = Database(url)
    with database.transaction() as session:
        number = replicas.join(session, role="all", host="here", process=1)
        replicas.forget(session, number)
    database.close()
    return number


def test_numbers_are_not_given_again_to_what_is_no_longer_there(
    plant: Database, target: str, databases: Databases, empty_template: str, tmp_path: Path
) -> None:
    """Nor behind the way back, nor when nothing was numbered in between."""
    assert [join(plant.url) for _ in range(3)] == [1, 2, 3]
    move(plant.url, target)
    back, again = (databases.copy(empty_template, tmp_path / name) for name in ("back.db", "again.db"))
    move(target, back)
    assert join(back) == 4
    move(back, again)
    assert [join(target), join(again)] == [4, 5]
    for url in (back, again):
        databases.drop(url)


def test_a_number_behind_the_rows_that_are_there_is_not_given_again_either(plant: Database, target: str) -> None:
    assert join(plant.url) == 1
    with plant.transaction() as session:
        assert [replicas.join(session, role="all", host="here", process=one) for one in (1, 2)] == [2, 3]
        replicas.forget(session, 3)
    move(plant.url, target)
    assert join(target) == 4


def test_postgresql_remembers_the_numbers_of_every_table(plant: Database, target: str) -> None:
    if plant.kind != "postgresql" or not target.startswith("postgresql"):
        pytest.skip("SQLite remembers those of the replicas only")
    with plant.transaction() as session:
        quarantine.add(session, [Rejection(START, "key", None, "bad_frame", "detail", b"")])
        session.execute(delete(QuarantineRow))
    move(plant.url, target)
    moved = Database(target)
    with moved.transaction() as session:
        quarantine.add(session, [Rejection(START, "key", None, "bad_frame", "detail", b"")])
        assert session.scalars(select(QuarantineRow.id)).all() == [2]
    moved.close()


def test_a_database_that_holds_data_is_refused(plant: Database, target: str) -> None:
    other = Database(target)
    with other.transaction() as session:
        machines.create(session, machine(id="other"))
    other.close()
    before = contents(target)
    with pytest.raises(TransferFailed, match="holds 2 rows"):
        move(plant.url, target)
    assert contents(target) == before


def test_a_database_in_use_is_refused(plant: Database, target: str) -> None:
    plant.claim()
    with pytest.raises(DatabaseUnusable, match="in use by another service"):
        move(plant.url, target)


def test_what_cannot_be_taken_over_leaves_nothing_behind(full: Database, target: str) -> None:
    """A reference to a row that is not there, as of a store that was mended by hand, in the last table but few."""
    wrong = "UPDATE deliveries SET event_id = 99 WHERE id = 2"
    if full.kind == "sqlite":
        with closing(sqlite3.connect(full.engine.url.database or "", isolation_level=None)) as unchecked:
            unchecked.execute(wrong)
    else:
        with connection(full.url) as unchecked:
            unchecked.execute("SET session_replication_role = replica")
            unchecked.execute(wrong)
    with pytest.raises(IntegrityError):
        move(full.url, target)
    assert all(rows == [] for rows in contents(target).values())


def test_what_is_no_number_is_null_in_the_other(plant: Database, target: str) -> None:
    """Older releases stored it in SQLite's JSON, where it can be; PostgreSQL cannot hold it."""
    with plant.transaction() as session:
        store_identification(session, identification(), run_id=1)
        if plant.kind == "sqlite":
            session.execute(text("""UPDATE identifications SET options = '{"seed": NaN, "starts": [Infinity, 1.5]}'"""))
        else:
            session.execute(text("""UPDATE identifications SET options = '{"seed": null, "starts": [null, 1.5]}'"""))
        session.execute(text("UPDATE identifications SET noise_floor = :nan"), {"nan": math.nan})
    move(plant.url, target)
    moved = Database(target)
    with moved.reading() as session:
        (options,) = session.scalars(text("SELECT options FROM identifications").columns(options=JSON()))
        assert options == {"seed": None, "starts": [None, 1.5]}
        (floor,) = session.scalars(text("SELECT noise_floor FROM identifications").columns(noise_floor=Float()))
        assert floor is None or math.isnan(floor)
    moved.close()


def test_a_source_that_is_not_there_is_not_made(tmp_path: Path, unmade_target: str) -> None:
    """As of a name that was mistyped: moving nothing would look like success."""
    with pytest.raises(DatabaseUnusable, match=r"there is no database file .*mistyped\.db"):
        move(sqlite_url(tmp_path / "mistyped.db"), unmade_target)
    assert list(tmp_path.glob("*.db")) == []


def test_a_source_that_holds_nothing_of_ours_is_left_alone(databases: Databases, target: str, tmp_path: Path) -> None:
    empty = databases.new(tmp_path / "empty.db")
    (tmp_path / "empty.db").touch()
    with pytest.raises(DatabaseUnusable, match=r"empty.* holds no data of Rundown"):
        move(empty, target)
    opened = create_engine(empty)
    assert inspect(opened).get_table_names() == []
    opened.dispose()
    databases.drop(empty)


OLD_TARGETS = ("/api/v1/machines/a\0b", "C:\\x00 \0", "\\\0\\\\", "C:\\x00")


def audited(database: Database, *targets: str, who: str = "anna") -> None:
    """Write the audit trail like a release that let every character in."""
    with database.transaction() as session:
        for target in targets:
            number, before = audit.head(session)
            row = AuditRow(
                number=number + 1, at=START, who=who, address="", operation="x", target=target, outcome="", previous=before
            )
            row.hash = audit.digest(row)
            session.add(row)
            session.merge(AuditHeadRow(id=audit.HEAD, number=row.number, hash=row.hash))
            session.flush()


@pytest.fixture
def with_nul(tmp_path: Path) -> Iterator[Database]:
    """Only SQLite holds it."""
    one = Database(sqlite_url(tmp_path / "with_nul.db"))
    with one.transaction() as session:
        machines.create(session, machine())
        session.add(TimelineRow(machine_id="pump-7", at=START, kind="note", text="two\nlines\0", by="x", created_at=START))
    audited(one, *OLD_TARGETS)
    yield one
    one.close()


def test_nul_in_a_text_is_escaped_where_it_cannot_be_and_the_audit_trail_holds(
    with_nul: Database, target: str, tmp_path: Path
) -> None:
    moved = move(with_nul.url, target)
    assert moved.rows["audit"] == len(OLD_TARGETS)
    to_postgresql = target.startswith("postgresql")
    assert moved.escaped == ({"audit.target": 3, "timeline.text": 1} if to_postgresql else {})
    move(target, back := sqlite_url(tmp_path / "back.db"))
    for url in (target, back):
        opened = Database(url)
        with opened.reading() as session:
            assert audit.verify(session, known=[audit.head(session)]) == []
            texts = session.scalars(select(AuditRow.target).order_by(AuditRow.number)).all()
            note = session.scalars(select(TimelineRow.text)).one()
        opened.close()
        if to_postgresql:
            assert texts[0] == "/api/v1/machines/a\\x00b"
            assert note == "two\nlines\\x00"
            assert tuple(map(nul_unescaped, texts[:3])) == OLD_TARGETS[:3]
        else:
            assert (tuple(texts), note) == (OLD_TARGETS, "two\nlines\0")


def test_nul_in_json_is_taken_over_as_it_is(full: Database, target: str) -> None:
    with full.transaction() as session:
        session.execute(update(AlertRow).where(AlertRow.id == 1).values(evidence={"said": "a\0b"}))
    assert move(full.url, target).escaped == {}
    opened = Database(target)
    with opened.reading() as session:
        assert session.scalars(select(AlertRow.evidence).where(AlertRow.id == 1)).one() == {"said": "a\0b"}
    opened.close()


def test_an_entry_that_was_changed_behind_the_move_is_found(with_nul: Database, tmp_path: Path) -> None:
    move(with_nul.url, url := sqlite_url(tmp_path / "changed.db"))
    opened = Database(url)
    with opened.transaction() as session:
        session.execute(text("DROP TRIGGER audit_no_update"))
        session.execute(update(AuditRow).where(AuditRow.number == 2).values(target="C:\\x00 \\x00"))
    with opened.reading() as session:
        assert [(one.number, one.reason) for one in audit.verify(session)] == [(2, "was changed")]
    opened.close()


def test_a_text_that_is_too_long_with_nul_escaped_is_named(with_nul: Database, target: str) -> None:
    audited(with_nul, "", who="\0" + 199 * "x")
    if not target.startswith("postgresql"):
        assert move(with_nul.url, target).escaped == {}
        return
    with pytest.raises(
        TransferFailed, match=r"audit \(5\): who holds NUL, .* 203 characters, of which 200 are allowed: shorten it"
    ):
        move(with_nul.url, target)
    assert all(rows == [] for rows in contents(target).values())
