"""Every error that is told to whoever asked has a category, and every category a status."""

from collections.abc import Iterator

import pytest

from estimator.errors import Damaged, DomainError, Invalid, Missing, Unavailable
from estimator.machine.document import DocumentError
from service.api.application import LISTED  # with every module whose errors reach HTTP
from service.http.error_status import STATUS, status_of
from service.identification.job_quota import QuotaExceeded
from storage.encoding.sample_blocks import DamagedBlock
from storage.machines.machines import MachineUnknown


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


@pytest.mark.parametrize("kind", [one for one in ERRORS if issubclass(one, Missing) and hasattr(one, "subject")])
def test_of_what_is_missing_it_is_told_where_it_is_listed(kind: type[Missing]) -> None:
    assert kind.subject in LISTED, f"LISTED of service/api/application.py lacks '{kind.subject}' of {kind.__name__}"


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
