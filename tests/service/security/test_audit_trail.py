"""The audit trail: what is in it, that it is written with what it tells of, and that a change of it is found."""

import logging
from contextlib import closing
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlalchemy.exc import DBAPIError

from service.security import api_keys
from service.security.audit_watch import LOOK_S, AuditWatch
from service.security.role import Role
from storage.database.engine import Database
from storage.operation import audit
from storage.operation.audit import AuditedOperation
from tests.api_in_process import PREFIX, Api, problem, value
from tests.end_to_end.processes import Service, rundown
from tests.plant import KEY
from tests.service.security.conftest import Filled, bearer

NOTES = f"{PREFIX}/machines/{KEY.machine}/timeline"
NOTE = {"at": "2026-01-01T00:00:00Z", "text": "looked", "by": "x"}


@pytest.fixture
def trail(database: Database) -> Database:
    """Five entries."""
    with database.transaction() as session:
        for number in range(5):
            audit.append(session, AuditedOperation("anna", "127.0.0.1", "set_limits", f"machine {number}", "done"))
    return database


def broken(database: Database, *statements: str) -> list[tuple[int, str]]:
    """Return what is found after somebody changed the file itself, without its triggers."""
    with database.engine.begin() as connection:
        if connection.dialect.name == "postgresql":
            for name in ("audit", "audit_head"):
                connection.execute(text(f"ALTER TABLE {name} DISABLE TRIGGER ALL"))
        else:
            for name in ("audit_no_update", "audit_no_delete", "audit_head_follows", "audit_head_no_delete"):
                connection.execute(text(f"DROP TRIGGER IF EXISTS {name}"))
        for statement in statements:
            connection.execute(text(statement))
    with database.reading() as session:
        return [(one.number, one.reason) for one in audit.verify(session)]


def test_a_trail_that_nobody_touched_holds(trail: Database) -> None:
    with trail.reading() as session:
        assert audit.verify(session) == []
        number, digest = audit.head(session)
        assert (number, len(digest)) == (5, 64)
        assert audit.verify(session, known=[(5, digest)]) == []


OTHER_ENTRY = (
    "audit (number, at, who, address, operation, target, outcome, previous, hash) VALUES (3, 0, '', '', '', '', '', '', '')"
)
CHANGES = [
    "UPDATE audit SET who = 'x'",
    "DELETE FROM audit",
    f"INSERT INTO {OTHER_ENTRY} ON CONFLICT (number) DO UPDATE SET who = 'x'",
]


@pytest.mark.parametrize("statement", CHANGES)
def test_the_database_itself_refuses_changes(trail: Database, statement: str) -> None:
    with pytest.raises(DBAPIError, match="append-only"), trail.engine.begin() as connection:
        connection.execute(text(statement))


@pytest.mark.parametrize(
    "statement",
    [
        f"INSERT OR REPLACE INTO {OTHER_ENTRY}",
        f"REPLACE INTO {OTHER_ENTRY}",
        f"REPLACE INTO {OTHER_ENTRY}".replace("(3", "('3'"),
        f"REPLACE INTO {OTHER_ENTRY}".replace("number", "rowid"),
        "INSERT OR REPLACE INTO audit SELECT number, at, 'x', address, operation, target, outcome, previous, hash FROM audit",
        f"INSERT OR IGNORE INTO {OTHER_ENTRY}",
    ],
)
def test_no_entry_is_replaced(trail: Database, statement: str) -> None:
    if trail.kind != "sqlite":
        pytest.skip("only SQLite has a REPLACE")
    with pytest.raises(DBAPIError, match="append-only"), trail.engine.begin() as connection:
        connection.execute(text(statement))
    with trail.transaction() as session:
        assert audit.append(session, AuditedOperation("anna", "127.0.0.1", "set_limits", "the next", "done")).number == 6
        assert audit.verify(session) == []


@pytest.mark.parametrize(
    "statement",
    [
        "DELETE FROM audit_head",
        "UPDATE audit_head SET number = 3, hash = (SELECT hash FROM audit WHERE number = 3)",
        "UPDATE audit_head SET number = 0",
        "UPDATE audit_head SET number = 6",
        "UPDATE audit_head SET hash = 'x'",
        "UPDATE audit_head SET id = 2",
        "UPDATE audit_head SET number = 7, hash = 'x'",
        "INSERT INTO audit_head VALUES (1, 3, 'x') ON CONFLICT (id) DO UPDATE SET number = 3",
        "INSERT OR REPLACE INTO audit_head VALUES (1, 3, 'x')",
        "REPLACE INTO audit_head (id, number, hash) SELECT '1', number, hash FROM audit WHERE number = 3",
        "UPDATE OR REPLACE audit_head SET id = 1, number = 3",
        "TRUNCATE audit_head",
    ],
)
def test_the_head_only_follows_an_entry(trail: Database, statement: str) -> None:
    only = {"sqlite": "REPLACE", "postgresql": "TRUNCATE"}
    if any(word in statement and trail.kind != kind for kind, word in only.items()):
        pytest.skip("no statement of this database")
    with trail.reading() as session:
        before = audit.head(session)
    with pytest.raises(DBAPIError, match="audit trail"), trail.engine.begin() as connection:
        connection.execute(text(statement))
    with trail.transaction() as session:
        assert audit.head(session) == before
        assert audit.append(session, AuditedOperation("anna", "127.0.0.1", "set_limits", "the next", "done")).number == 6
        assert audit.verify(session) == []


CUT = (
    "DELETE FROM audit WHERE number > 3",
    "UPDATE audit_head SET number = 3, hash = (SELECT hash FROM audit WHERE number = 3)",
)


def test_a_cut_of_end_and_head_is_noticed_by_the_service_and_told_by_its_log(
    trail: Database, caplog: pytest.LogCaptureFixture, tmp_path: Path
) -> None:
    caplog.set_level(logging.INFO)
    watch = AuditWatch(trail, clock=lambda: 0.0)
    watch.check()
    watch.check()
    assert (watch.warnings, watch.gauges) == ([], {"rundown_audit_trail_holds": 1.0})
    noted = [record.getMessage() for record in caplog.records]
    assert len(noted) == 1
    assert broken(trail, *CUT) == []  # by itself what is left holds
    url = trail.engine.url.render_as_string(hide_password=False)
    (tmp_path / "rundown.log").write_text(f"INFO service: ready\n2026-01-01 INFO {noted[0]}\n")
    told = rundown("audit", "verify", "--noted-in", str(tmp_path / "rundown.log"), "--database", url)
    assert (told.returncode, "entry 5: was noted, and there are only 3" in told.stderr) == (1, True)
    watch.check()
    assert watch.warnings == ["the audit trail was changed: entry 5, which was there before, is not there as it was"]
    assert watch.gauges == {"rundown_audit_trail_holds": 0.0}
    assert "rundown audit verify --noted 5:" in caplog.text
    assert "holds no note" in rundown("audit", "verify", "--noted-in", __file__, "--database", url).stderr


def test_what_is_cut_off_while_no_service_runs_is_reported_by_its_log(tmp_path: Path) -> None:
    service = Service(tmp_path)
    with closing(Database(service.database)) as database, database.transaction() as session:
        for name in "abcde":
            api_keys.create(session, name=name, role=Role.VIEWER, plants=None, days=1.0)
    with closing(service.client), service.running():
        assert rundown("key", "create", "late", "--role", "viewer", "--database", service.database).returncode == 0
    verify = ("audit", "verify", "--noted-in", str(service.log), "--database", service.database)
    assert rundown(*verify).returncode == 0
    with closing(Database(service.database)) as database:
        assert broken(database, *(one.replace("3", "5") for one in CUT)) == []
    told = rundown(*verify)
    assert (told.returncode, told.stdout) == (1, "")
    assert "entry 6: was noted, and there are only 5" in told.stderr


def test_the_newest_entry_is_in_the_log_at_the_start_and_each_day(trail: Database, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO)
    now = 0.0
    watch = AuditWatch(trail, clock=lambda: now)
    for _ in range(3 * 144 + 1):
        watch.check()
        now += LOOK_S
    assert caplog.text.count("audit trail: the newest entry is 5:") == 4


def test_an_entry_that_grew_into_another_is_noticed(trail: Database) -> None:
    watch = AuditWatch(trail)
    watch.check()
    broken(trail, "UPDATE audit SET hash = 'x' WHERE number = 5", "UPDATE audit_head SET hash = 'x'")
    watch.check()
    assert len(watch.warnings) == 1
    watch.check()
    assert len(watch.warnings) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("who = x'00ff'", "entry 3: was changed: its `who` is no text"),
        ("hash = x'00ff'", "entry 3: was changed: its `hash` is no text"),
        ("target = CAST(x'61ff62' AS TEXT)", "entry 3: was changed: its `target` is no text"),
        ("at = 'yesterday'", "entry 3: was changed: its `at` is no number"),
        ("at = x'01'", "entry 3: was changed: its `at` is no number"),
        ("previous = 7", "entry 3: does not follow the entry before it"),
    ],
)
def test_an_entry_that_is_no_text_is_named(trail: Database, change: str, words: str) -> None:
    if trail.kind != "sqlite":
        pytest.skip("only SQLite takes anything for a text")
    broken(trail, f"UPDATE audit SET {change} WHERE number = 3")
    told = rundown("audit", "verify", "--database", trail.engine.url.render_as_string(hide_password=False))
    assert (told.returncode, told.stdout) == (1, "")
    assert words in told.stderr
    assert "Traceback" not in told.stderr


@pytest.mark.parametrize("column", ["at", "who", "address", "operation", "target", "outcome"])
def test_a_changed_entry_is_found(trail: Database, column: str) -> None:
    changed = "at + 1" if column == "at" else "'x'"
    assert broken(trail, f"UPDATE audit SET {column} = {changed} WHERE number = 3") == [(3, "was changed")]


def test_a_changed_entry_with_its_hash_made_again_is_found(trail: Database) -> None:
    with trail.reading() as session:
        row = audit.newest(session, limit=3)[-1]
        row.who = "mallory"
        forged = audit.digest(row)
        session.rollback()
    found = broken(trail, f"UPDATE audit SET who = 'mallory', hash = '{forged}' WHERE number = 3")
    assert found == [(4, "does not follow the entry before it")]


def test_removed_entries_are_found(trail: Database) -> None:
    assert [number for number, _ in broken(trail, "DELETE FROM audit WHERE number = 3")] == [3]
    assert 1 in [number for number, _ in broken(trail, "DELETE FROM audit WHERE number = 1")]


def test_a_removed_end_is_found(trail: Database) -> None:
    assert broken(trail, "DELETE FROM audit WHERE number > 3") == [(5, "the last entry should be 5, and is 3")]


def test_reordered_entries_are_found(trail: Database) -> None:
    swap = ("UPDATE audit SET number = 99 WHERE number = 2", "UPDATE audit SET number = 2 WHERE number = 4")
    found = broken(trail, *swap, "UPDATE audit SET number = 4 WHERE number = 99")
    assert {2, 4} <= {number for number, _ in found}


def test_a_chain_forged_throughout_does_not_fit_what_was_noted(trail: Database) -> None:
    with trail.reading() as session:
        known = audit.head(session)
    broken(trail, "DELETE FROM audit", "DELETE FROM audit_head")
    with trail.transaction() as session:
        for number in range(6):
            audit.append(session, AuditedOperation("nobody", "127.0.0.1", "nothing", str(number), "done"))
    with trail.reading() as session:
        assert audit.verify(session) == []
        assert [one.reason for one in audit.verify(session, known=[known])] == ["is not the entry that was noted"]


def test_the_command_says_what_does_not_hold(trail: Database) -> None:
    url = trail.engine.url.render_as_string(hide_password=False)
    held = rundown("audit", "verify", "--database", url)
    assert held.returncode == 0, held.stderr
    noted = held.stdout.split(": ")[1].strip()
    assert rundown("audit", "verify", "--noted", noted, "--database", url).returncode == 0
    broken(trail, "UPDATE audit SET outcome = 'refused' WHERE number = 2")
    found = rundown("audit", "verify", "--database", url)
    assert found.returncode == 1
    assert "entry 2: was changed" in found.stderr


# --- what is in it --------------------------------------------------------------------------------------------------


def test_a_trail_that_is_gone_is_no_trail_that_holds(trail: Database) -> None:
    with trail.engine.begin() as connection:
        connection.execute(text("DROP TABLE audit"))
    found = rundown("audit", "verify", "--database", trail.engine.url.render_as_string(hide_password=False))
    assert (found.returncode, found.stdout) == (1, "")
    assert "audit" in found.stderr
    assert "Traceback" not in found.stderr


def test_a_change_is_in_the_trail_with_who_made_it(api: Api, filled: Filled) -> None:
    value(api.ask("POST", NOTES, json=NOTE, headers=bearer(filled.keys["own"])), 201)
    newest = value(api.ask("GET", f"{PREFIX}/audit?limit=1", headers=bearer(filled.keys["admin"])))[0]
    prefix = filled.keys["own"].split("_")[1]
    assert newest["who"] == f"own admin (key {prefix})"
    assert (newest["operation"], newest["target"], newest["outcome"]) == ("add_timeline_entry", f"POST {NOTES}", "done")
    assert newest["address"] == "127.0.0.1"


def test_what_was_not_done_is_not_said_to_be_done(api: Api, filled: Filled) -> None:
    with api.database.reading() as session:
        before = audit.head(session)
    problem(api.ask("POST", NOTES, json={"at": "never"}, headers=bearer(filled.keys["own"])), 422)
    problem(api.ask("POST", f"{PREFIX}/alerts/1/unshelve", json={"by": "x"}, headers=bearer(filled.keys["own"])), 428)
    with api.database.reading() as session:
        assert audit.head(session) == before


def test_what_was_refused_for_the_role_is_in_it(api: Api, filled: Filled) -> None:
    problem(api.ask("POST", NOTES, json=NOTE, headers=bearer(filled.keys["viewer"])), 403)
    with api.database.reading() as session:
        row = audit.newest(session, limit=1)[0]
        assert (row.operation, row.outcome) == ("add_timeline_entry", "refused")
        assert audit.verify(session) == []


def test_a_refusal_of_what_no_store_holds_is_in_it_too(api: Api, filled: Filled) -> None:
    problem(api.ask("POST", f"{PREFIX}/machines/%00/timeline", json=NOTE, headers=bearer(filled.keys["viewer"])), 403)
    with api.database.reading() as session:
        row = audit.newest(session, limit=1)[0]
        assert (row.target, row.outcome) == (f"POST {PREFIX}/machines/\\x00/timeline", "refused")
        assert audit.verify(session) == []


def test_the_trail_is_for_administrators_of_all_plants(api: Api, filled: Filled) -> None:
    for key in ("viewer", "analyst", "operator", "own", "source"):
        problem(api.ask("GET", f"{PREFIX}/audit", headers=bearer(filled.keys[key])), 403)


def test_keys_made_and_revoked_by_the_command_are_in_it(store: Database) -> None:
    url = store.engine.url.render_as_string(hide_password=False)
    made = rundown("key", "create", "shift", "--role", "viewer", "--plant", KEY.plant, "--database", url)
    prefix = made.stdout.split("_")[1]
    assert rundown("key", "revoke", prefix, "--database", url).returncode == 0
    assert rundown("key", "revoke", "nothing", "--database", url).returncode == 1
    listed = rundown("key", "list", "--database", url).stdout
    assert f"{prefix}  revoked  viewer    {KEY.plant}" in listed
    assert made.stdout.strip() not in listed
    with store.reading() as session:
        assert [row.operation for row in audit.newest(session, limit=2)] == ["revoke_key", "create_key"]
    assert api_keys.COMMAND == "rundown key"
