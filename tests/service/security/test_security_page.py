"""The page about security says of every operation what it needs."""

import re

from service.api.application import application
from storage.database.engine import Database
from tests.end_to_end.processes import ROOT


def test_the_table_of_roles_is_that_of_the_application() -> None:
    page = (ROOT / "docs" / "security.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| ((?:nothing|the role)[^|]*) \| ([^|]*) \|$", page, re.MULTILINE))
    needed: dict[str, set[str]] = {}
    for one in application(Database("sqlite://"), dict).state.operations:
        needed.setdefault(one.requirement.words, set()).add(one.name)
    assert rows.keys() == needed.keys()
    for words, names in needed.items():
        if words not in ("nothing", "the role viewer"):
            assert set(re.findall(r"`(\w+)`", rows[words])) == names, words
