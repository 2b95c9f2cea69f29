"""Tests what a person can do about a failed job."""

import pytest

from service.api.findings.job_remedies import ANY_OTHER, REMEDIES, remedy


@pytest.mark.parametrize(
    ("error", "begins"),
    [
        ("NotEnoughData: too few", "NotEnoughData"),
        ("given up after 3 attempts: OutOfTime: 300 s", "OutOfTime"),
        ("given up after 3 attempts: Stuck: a worker", "Stuck"),
        ("SamplesReleased: the samples of run 7 were deleted", "SamplesReleased"),
        ("its result cannot be stored: OSError: full", "its result cannot be stored"),
    ],
)
def test_an_error_has_its_remedy(error: str, begins: str) -> None:
    assert remedy(error) == REMEDIES[begins]


def test_any_other_error_has_one_too_and_none_has_none() -> None:
    assert remedy("LinAlgError: singular") == ANY_OTHER
    assert remedy(None) is None
