"""Every error that is told to whoever asked has a category, and every category a status."""

import ast
from collections.abc import Iterable, Iterator, Mapping

import pytest

from estimator.errors import Damaged, DomainError, Invalid, Unavailable
from estimator.machine.document import DocumentError
from service.api.application import LISTED, ROWS  # with every module whose errors reach HTTP
from service.api.conventions.error_handlers import require_every_hint
from service.http.error_status import STATUS, status_of
from service.identification.job_quota import QuotaExceeded
from storage.encoding.sample_blocks import DamagedBlock
from storage.machines.machines import MachineUnknown
from tests.paths import PACKAGES, ROOT
from tests.syntax_trees import parsed, statements


def subclasses(kind: type[DomainError]) -> Iterator[type[DomainError]]:
    """Yield every class below one, as far as it is imported."""
    for one in kind.__subclasses__():
        yield one
        yield from subclasses(one)


ERRORS = sorted(
    {one for one in subclasses(DomainError) if one.__module__ != DomainError.__module__}, key=lambda one: one.__name__
)


def test_every_category_has_a_status_of_its_own() -> None:
    """Of its own but for damage: it is answered as what does not work at present, whoever finds it."""
    assert set(STATUS) == set(DomainError.__subclasses__())
    assert STATUS[Damaged] == STATUS[Unavailable]
    assert len(set(STATUS.values())) == len(STATUS) - 1


@pytest.mark.parametrize("kind", ERRORS)
def test_every_error_is_of_one_category(kind: type[DomainError]) -> None:
    assert sum(category in kind.__mro__ for category in STATUS) == 1, f"{kind.__name__} derives from one of {list(STATUS)}"


def test_of_what_is_missing_it_is_told_where_it_is_listed() -> None:
    require_every_hint(LISTED)
    assert {subject for _, subject in ROWS.values()} <= set(LISTED)
    without = {subject: hint for subject, hint in LISTED.items() if subject != "run"}
    with pytest.raises(LookupError, match=r"LISTED .* lacks 'run' of RunUnknown"):
        require_every_hint(without)


def test_an_error_of_what_is_missing_needs_a_subject(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(MachineUnknown, "subject")
    with pytest.raises(LookupError, match=r"storage.machines.machines.MachineUnknown needs a subject"):
        require_every_hint(LISTED)


def test_an_error_says_what_a_special_answer_needs() -> None:
    wrong = DocumentError([("name", "is missing")])
    assert (status_of(wrong), wrong.detail, wrong.field_errors) == (
        422,
        "the machine document is wrong",
        [("name", "is missing")],
    )
    assert isinstance(wrong, Invalid)
    assert MachineUnknown("M1").detail == "no machine M1"
    assert "restore a backup" in DamagedBlock("block 3 cannot be read").detail
    assert QuotaExceeded("wait").retry_after_s == 30


REACHED = (
    "service/api",
    "service/balancing",
    "service/identification",
    "service/monitoring",
    "storage/alerts",
    "storage/encoding",
    "storage/findings",
    "storage/machines",
    "storage/measurements",
)
"""Rooms whose errors reach whoever asks over HTTP: the API's, and the jobs, findings and repositories that it asks."""


def own_classes(packages: Iterable[str]) -> dict[str, set[str]]:
    """Return the classes of some packages with the names of their bases."""
    paths = [path for package in packages for path in (ROOT / package).rglob("*.py")]
    nodes = [node for path in paths for node in statements(parsed(path.read_text())) if isinstance(node, ast.ClassDef)]
    return {node.name: {ast.unparse(one).rpartition(".")[2] for one in node.bases} for node in nodes}


def without_category(source: str, classes: Mapping[str, set[str]]) -> list[str]:
    """Return the errors of this project that some source raises though they derive from no category."""
    categories = {one.__name__ for one in STATUS} | {"HTTPException"}
    found = []
    for node in statements(parsed(source)):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call | ast.Name):
            called = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            bases = {ast.unparse(called).rpartition(".")[2]}
            while more := {base for one in bases for base in classes.get(one, ())} - bases:
                bases |= more
            if len(bases) > 1 and not bases & categories:
                found.append(ast.unparse(called))
    return found


def test_no_error_without_a_category_is_raised_where_it_would_reach_a_caller() -> None:
    """It would be answered as an unexpected error, with status 500."""
    classes = own_classes(PACKAGES)
    paths = [path for room in REACHED for path in sorted((ROOT / room).rglob("*.py"))]
    found = {path.relative_to(ROOT).as_posix(): without_category(path.read_text(), classes) for path in paths}
    assert {path: errors for path, errors in found.items() if errors} == {}
    assert {"MachineUnknown", "DocumentError", "FitFailed"} <= set(classes)


def test_an_error_without_a_category_is_found() -> None:
    classes = {"FitFailed": {"ValueError"}, "MachineUnknown": {"Missing"}, "Stale": {"MachineUnknown"}}
    source = "def get():\n    raise Stale('M1')\n\n\ndef fit():\n    raise FitFailed\n    raise ValueError('of a validator')\n"
    assert without_category(source, classes) == ["FitFailed"]
