"""Numbers in what is said to people."""

import pytest

from estimator.diagnosis.finding_kind import SizePart
from service.wording.described_finding import DescribedFinding
from service.wording.finding_words import element_words, interval, misalignment_words, part_words, rounded


@pytest.mark.parametrize(
    ("value", "digits", "said"),
    [
        (7974.0, 3, "7970"),
        (13_002.0, 3, "13000"),
        (999.6, 3, "1000"),
        (12.345, 3, "12.3"),
        (0.012345, 3, "0.0123"),
        (-45.6, 2, "-46"),
        (123.0, 2, "120"),
        (0.0, 3, "0"),
    ],
)
def test_numbers_are_written_out(value: float, digits: int, said: str) -> None:
    assert rounded(value, digits) == said


def test_an_element_whose_coefficients_change_together_is_told_once() -> None:
    parts = [
        {
            "name": "coupling.C1.coefficients",
            "unit": "%",
            "value": 53.4,
            "lower": 48.7,
            "upper": 58.2,
            "sigma": 27.3,
            "members": ["coupling.C1.kxx"],
        },
        {
            "name": "bearing.B2.coefficients",
            "unit": "%",
            "value": 2.0,
            "lower": -3.0,
            "upper": 7.0,
            "sigma": 0.8,
            "members": ["bearing.B2.kxx"],
        },
    ]
    told = DescribedFinding("misalignment", "coupling.C1", {"parts": parts, "form": "combined", "quantities": {}})
    assert misalignment_words(told) == {
        "judgement": "is going out of alignment (combined)",
        "size": "all coefficients of coupling C1 together +53 % (+49 to +58)",
    }


def test_what_an_older_release_stored_is_told_without_intervals() -> None:
    told = DescribedFinding("coupling", "coupling.C1", {"quantities": {"coupling.C1.stiffness_per_cent": 12.3}})
    assert element_words(told) == {"size": "stiffness +12 %"}


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (SizePart("disc.D1.unbalance", "g mm", 7962.4, 7488.0, 8436.0), "unbalance of disc D1 7962 ± 474 g·mm"),
        (SizePart("machine.viscosity", "%", 80.0, 79.6, 80.4), "viscosity +80.0 % (+79.6 to +80.4)"),
        (SizePart("coupling.C1.misalignment_moment", "N m", 4.4, 4.0, 4.8, before=4.9), "4.9 → 9.3 N m (change +4.0 to +4.8)"),
        (
            SizePart("coupling.C1.misalignment_moment", "N m", -16.63, -20.53, -12.74, before=143.15),
            "143 → 127 N m (change -21 to -13)",
        ),
    ],
)
def test_a_figure_has_its_unit_and_interval(part: SizePart, said: str) -> None:
    assert said in part_words(part)
    assert interval(part) in said
