"""`rundown key`: what a key cannot be made with is said in a line, before anything is stored."""

import pytest
from typer.testing import CliRunner

from service.commands.app import app
from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from storage.operation import api_keys as keys


def refused(*arguments: str) -> str:
    ended = CliRunner().invoke(app, ["key", *arguments])
    assert ended.exit_code == 1, ended.output
    (line,) = ended.output.splitlines()
    return line


@pytest.mark.parametrize("days", ["inf", "nan", "1e300", "1e9", "0", "-1"])
def test_days_have_bounds(database: Database, days: str) -> None:
    said = refused("create", "anna", "--role", "viewer", "--days", days, "--database", database.url)
    assert "--days" in said
    assert "must be from 0.001 to 36500 days, which is a hundred years" in said
    with database.reading() as session:
        assert not keys.any_exist(session)


def test_a_misspelt_role_gets_those_like_it(database: Database) -> None:
    said = refused("create", "anna", "--role", "amdin", "--database", database.url)
    assert said.endswith("; did you mean 'admin'?")


@pytest.mark.parametrize("plant", ["", "p\n1", "p\n", "p,q", "p" * 65])
def test_a_plant_is_named_as_machines_name_it(database: Database, plant: str) -> None:
    said = refused("create", "anna", "--role", "viewer", "--plant", "p1", "--plant", plant, "--database", database.url)
    assert said == f"rundown: --plant {plant!r} is no plant: it must have 1 to 64 letters, digits, '_' and '-'"
    with database.reading() as session:
        assert not keys.any_exist(session)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("", "the name has 0 characters: it must have 1 to 120"),
        ("n" * 121, "the name has 121 characters: it must have 1 to 120"),
        ("an\x07na", "character 3 of the name is a control character (U+0007): leave it out"),
        ("anna\n", "character 5 of the name is a control character (U+000A): leave it out"),
        ("\x7fanna", "character 1 of the name is a control character (U+007F): leave it out"),
        ("an\x9bna", "character 3 of the name is a control character (U+009B): leave it out"),
        ("an\u2028na", "character 3 of the name is a line break (U+2028): leave it out"),
        ("an\udcffna", "character 3 of the name is no text in UTF-8 (U+DCFF): leave it out"),
    ],
)
def test_what_is_wrong_with_a_name_is_said(database: Database, name: str, reason: str) -> None:
    assert refused("create", name, "--role", "viewer", "--database", database.url) == f"rundown: {reason}"
    with database.reading() as session:
        assert not keys.any_exist(session)


@pytest.mark.parametrize("option", ["--days", "--overlap-days"])
def test_a_rotation_s_days_have_bounds(database: Database, option: str) -> None:
    with database.transaction() as session:
        row, _ = api_keys.create(session, name="anna", role=Role.of("viewer"), plants=None, days=1.0)
    for days in ("inf", "nan", "1e9", "-1"):
        assert f"rundown: {option} " in refused("rotate", row.prefix, option, days, "--database", database.url)
    with database.reading() as session:
        assert len(keys.list_all(session)) == 1


def test_a_hundred_years_are_not_too_long(database: Database) -> None:
    ended = CliRunner().invoke(app, ["key", "create", "a", "--role", "viewer", "--days", "36500", "--database", database.url])
    assert ended.exit_code == 0, ended.output


def test_a_list_without_keys_says_how_the_first_is_made(database: Database) -> None:
    ended = CliRunner().invoke(app, ["key", "list", "--database", database.url])
    assert (ended.exit_code, ended.output) == (0, "no key was ever made; the first: rundown key create NAME --role admin\n")


@pytest.mark.parametrize("command", ["rotate", "confirm", "revoke"])
def test_a_misspelt_key_gets_those_like_it(database: Database, command: str) -> None:
    assert refused(command, "12345678", "--database", database.url) == (
        "rundown: no key '12345678' is known; rundown key list shows all"
    )
    with database.transaction() as session:
        prefix = api_keys.create(session, name="anna", role=Role.of("viewer"), plants=None, days=1.0)[0].prefix
    assert refused(command, prefix[:-1], "--database", database.url) == (
        f"rundown: no key '{prefix[:-1]}' is known; did you mean '{prefix}'?"
    )
