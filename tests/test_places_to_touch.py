"""Places to touch for one more finding, delivery channel, bearing model and resource, tests and docs aside.

Each is added to a copy of the packages in as few files as may be, and then has to work there: declared, served, stored.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass

import pytest

from tests.additions.addition import Addition
from tests.additions.additions import ADDITIONS
from tests.additions.package_copy import PAGE, PackageCopy

SCRIPT = f"""
import json, pathlib, traceback
import pytest
import estimator, service, storage
assert estimator.__file__.startswith(FOLDER), estimator.__file__
from service.commands.openapi import text
from service.commands.page_declarations import write
OPENAPI = text()
failures = {{}}
for name, check in CHECKS.items():
    try:
        exec(compile(check, name, "exec"), {{"OPENAPI": OPENAPI}})
        failures[name] = ""
    except Exception:
        failures[name] = traceback.format_exc()
write(pathlib.Path("{PAGE}/declarations")) # as `make dashboard` does
assert pytest.main(["-q", "-p", "no:cacheprovider", "--import-mode=importlib", *TESTS]) == 0
pathlib.Path("failures.json").write_text(json.dumps(failures))
"""
"""Checks all additions in one process: to load the service and to write its document takes most of the time."""


@dataclass(frozen=True)
class Tried:
    """A copy with all additions. files: those that each took."""

    copy: PackageCopy
    files: Mapping[str, frozenset[str]]


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> Tried:
    """Add everything to one copy."""
    copy = PackageCopy(tmp_path_factory.mktemp("packages"))
    files = {}
    for one in ADDITIONS:
        copy.forget()
        one.add(copy)
        files[one.name] = frozenset(copy.touched)
    return Tried(copy, files)


@pytest.fixture(scope="module")
def failures(tried: Tried) -> Mapping[str, str]:
    """Run the checks of all additions; return what fails of each."""
    tests = sorted({file for one in ADDITIONS for file in one.tests})
    for file in tests:
        tried.copy.bring(file)
    checks = {one.name: one.check for one in ADDITIONS}
    tried.copy.run(f"FOLDER = {str(tried.copy.folder)!r}\nCHECKS = {checks!r}\nTESTS = {tests!r}\n{SCRIPT}")
    found: Mapping[str, str] = json.loads((tried.copy.folder / "failures.json").read_text())
    return found


@pytest.mark.parametrize("addition", ADDITIONS, ids=[one.name for one in ADDITIONS])
def test_one_more_takes_few_files_and_works(addition: Addition, tried: Tried, failures: Mapping[str, str]) -> None:
    assert len(tried.files[addition.name]) <= addition.most_files, tried.files[addition.name]
    assert failures[addition.name] == ""


@pytest.mark.parametrize(
    ("file", "said", "instead", "missing"),
    [
        (
            "service/monitoring/rules/rotor_findings.py",
            '{"de": "Anstreifen"}',
            "{}",
            "name of finding 'rub' is missing in: de",
        ),
        (
            "service/delivery/logbook.py",
            ', "de": "Betriebsbuch"',
            "",
            "title of channel kind 'logbook' is missing in: de",
        ),
    ],
)
def test_one_that_a_language_lacks_does_not_start(tried: Tried, file: str, said: str, instead: str, missing: str) -> None:
    with tried.copy.altered(file, said, instead), pytest.raises(AssertionError, match=missing):
        tried.copy.run("import service.api.application")
