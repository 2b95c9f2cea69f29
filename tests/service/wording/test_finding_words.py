"""Numbers in what is said to people."""

from dataclasses import replace

import pytest

from estimator.diagnosis.finding_kind import SizePart
from service.wording.described_finding import DescribedFinding
from service.wording.finding_words import (
    coupling_run_out_words,
    element_words,
    interval,
    misalignment_words,
    part_words,
    rounded,
    sensor_words,
    unbalance_words,
    whole_degrees,
)
from service.wording.language import ENGLISH, GERMAN


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


def test_an_element_whose_coefficients_change_together_is_reported_once() -> None:
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


def test_what_an_older_release_stored_is_reported_without_intervals() -> None:
    told = DescribedFinding("coupling", "coupling.C1", {"quantities": {"coupling.C1.stiffness_per_cent": 12.3}})
    assert element_words(told) == {"size": "stiffness +12 %"}


@pytest.mark.parametrize(
    ("part", "said"),
    [
        (SizePart("disc.D1.unbalance", "g mm", 7962.4, 7488.0, 8436.0), "unbalance of disc D1 7962 ± 474 g·mm"),
        (SizePart("machine.viscosity", "%", 80.0, 79.6, 80.4), "viscosity +80.0 % (+79.6 to +80.4)"),
        (
            SizePart("coupling.C1.offset_vertical", "um", -18.0, -20.0, -16.0, against="runs_before"),
            "offset vertical of coupling C1, compared with the runs just before the change, -18 ± 2 µm",
        ),
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


def test_angles_are_reported_from_0_to_359_degrees_as_in_all_tables() -> None:
    numbers = {"change_g_mm": 12.0, "change_deg": -45.4, "before_g_mm": 20.0, "after_g_mm": 30.0}
    told = DescribedFinding("unbalance", "disc.D1", {"quantities": numbers})
    assert unbalance_words(told) == {"size": "12.0 g·mm at 315°, from 20.0 to 30.0 g·mm"}
    assert whole_degrees(359.7) == 0


def test_the_face_of_a_coupling_is_reported_in_milliradians() -> None:
    numbers = {"offset_um": 12.0, "offset_deg": 359.8, "angle_urad": 250.0, "angle_deg": 90.0}
    told = DescribedFinding("rotating_coupling", "coupling.C1", {"quantities": numbers})
    assert coupling_run_out_words(told) == {"size": "bore by 12 µm at 0° and face by 0.25 mrad at 90°"}


def test_a_probe_whose_gain_stays_has_no_gain_of_minus_zero() -> None:
    told = DescribedFinding("sensor", "probe.P1", {"quantities": {"gain_per_cent": -0.3, "phase_deg": 12.0}})
    for language, gain in ((ENGLISH, "gain +0 %"), (GERMAN, "Verstärkung +0 %")):
        assert gain in sensor_words(replace(told, language=language))["size"]
