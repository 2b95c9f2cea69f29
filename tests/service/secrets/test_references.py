"""Permitted references to secrets: files of one folder, and variables with one prefix."""

import re

import pytest

from service.secrets.references import FILE_NAME, VARIABLE


@pytest.mark.parametrize("name", ["historian", "a.b-c_1", "A" * 100])
def test_names_of_files(name: str) -> None:
    assert re.fullmatch(FILE_NAME, name)


@pytest.mark.parametrize("name", ["", "..", ".hidden", "a/b", "/etc/passwd", "a b", "a\n", "A" * 101])
def test_names_that_lead_elsewhere_are_none(name: str) -> None:
    assert not re.fullmatch(FILE_NAME, name)


@pytest.mark.parametrize(
    ("name", "permitted"),
    [
        ("RUNDOWN_WEBHOOK_SECRET_SCADA_2", True),
        ("RUNDOWN_WEBHOOK_SECRET_" + "A" * 64, True),
        ("RUNDOWN_WEBHOOK_SECRET_" + "A" * 65, False),
        ("RUNDOWN_WEBHOOK_SECRET_", False),
        ("RUNDOWN_WEBHOOK_SECRET_scada", False),
        ("RUNDOWN_DATABASE", False),
        ("PATH", False),
    ],
)
def test_variables(name: str, permitted: bool) -> None:
    assert bool(re.fullmatch(VARIABLE, name)) == permitted
