"""Tests stored text that would steer a terminal, in what commands and logs say."""

import logging
import re

import pytest

from service.commands.terminal import print_line, print_text
from service.configuration.log_format import TextLines
from service.security import api_keys
from service.security.role import Role
from storage.database.engine import Database
from tests.end_to_end.processes import ROOT, rundown

STEERING = "a\x1b[2J\x07\x7f\x9b31m\u202etoor\u2066\u200f\nforged\r\u2028b\x00"
ESCAPED = "a\\x1b[2J\\x07\\x7f\\x9b31m\\u202etoor\\u2066\\u200f\\nforged\\r\\u2028b\\x00"


def test_a_key_s_name_steers_no_terminal(database: Database) -> None:
    with database.transaction() as session:
        name = STEERING.removesuffix("\x00")
        api_keys.create(session, name=name, role=Role.VIEWER, plants=[name], days=1)
    listed = rundown("key", "list", "--database", database.engine.url.render_as_string(hide_password=False))
    (line,) = listed.stdout.splitlines()
    assert line.count(ESCAPED.removesuffix("\\x00")) == 2


def test_a_line_is_one_line_and_lines_are_our_own(capsys: pytest.CaptureFixture[str]) -> None:
    print_line(f"Jörg, 10 µm ± 1 %: {STEERING}")
    print_text("one\ntwo \x9b31m", err=True)
    assert capsys.readouterr() == (f"Jörg, 10 µm ± 1 %: {ESCAPED}\n", "one\ntwo \\x9b31m\n")


def test_what_fails_names_what_was_given_plainly() -> None:
    told = rundown("document", "\x1b]0;x\x07no\u202e.yaml")
    assert told.returncode == 1
    assert "\\x1b]0;x\\x07no\\u202e.yaml" in told.stderr


def test_the_log_for_people_steers_none_either() -> None:
    record = logging.LogRecord("x", logging.INFO, "x", 1, "source %s", ("\x1b[2J\u202e",), None)
    assert TextLines("%(message)s").format(record) == "source \\x1b[2J\\u202e"


def test_no_command_says_anything_by_itself() -> None:
    saying = {one.name for one in (ROOT / "service").rglob("*.py") if re.search(r"\becho\(|\bprint\(", one.read_text())}
    assert saying == {"terminal.py", "demo.py"}  # the demo tells of its own machines only
