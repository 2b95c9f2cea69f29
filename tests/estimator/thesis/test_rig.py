"""The rig's printed data, and misalignment as growth of coefficients."""

import copy
import math

import numpy as np
import pytest
import yaml

from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import eigenvalues
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.thesis.rig import (
    ALIGNED_HZ,
    CASES,
    H1,
    SPEEDS_HZ,
    BearingGrowth,
    nominal_values,
    plane_frequencies,
    printed_growth,
    shaft_factors,
)
from tests.estimator.trains import ROOT, Document

DOCUMENT: Document = yaml.safe_load((ROOT / "examples" / "thesis-chapter-5-rig.yaml").read_text(encoding="utf-8"))
RIG = parse_machine(DOCUMENT)
NAMES = [one.name for one in unknowns(RIG, assemble_rotor(RIG)).coefficients]


def test_the_printed_response_belongs_to_eight_speeds() -> None:
    assert len(SPEEDS_HZ) == H1.size == 8
    assert np.abs(H1).min() > 50e-6
    assert np.abs(H1).max() < 70e-6


def test_printed_percentages_of_table_5_5_are_those_of_its_frequencies() -> None:
    """2.0, 1.40, 0.54; 2.66, 1.97, 0.54; 4.00, 1.97, 0.54 % in the print; the second of Case A₁ is 1.48 by its frequencies."""
    printed = {"A₁": (2.0, 1.48, 0.54), "B₁": (2.66, 1.97, 0.54), "C₁": (4.0, 1.97, 0.54)}
    for case in CASES:
        if case.frequencies_hz is not None:
            found = 100 * (np.array(case.frequencies_hz) / np.array(ALIGNED_HZ) - 1)
            assert found == pytest.approx(printed[case.name], abs=0.01)


def test_plane_frequencies_are_the_means_of_pairs() -> None:
    coefficients, _ = nominal_values(RIG)
    found = plane_frequencies(RIG, coefficients=coefficients)
    hertz = np.abs(eigenvalues(RIG)) / (2 * math.pi)
    assert found == pytest.approx([(hertz[0] + hertz[1]) / 2, (hertz[2] + hertz[3]) / 2, (hertz[4] + hertz[5]) / 2])


def test_the_printed_growth_is_that_of_one_damping_term_and_half_of_it_elsewhere() -> None:
    unknown = unknowns(RIG, assemble_rotor(RIG))
    for case in CASES:
        factors = dict(zip(NAMES, printed_growth(case, unknown), strict=True))
        assert factors.pop("bearing.B4.cyx") == pytest.approx(1 + case.growth)
        assert set(factors.values()) == {1 + case.growth / 2}


def test_factors_go_to_the_bearings_of_each_shaft_and_the_coupling_follows_the_second() -> None:
    factors = shaft_factors(RIG, driver=2.0, driven=3.0)
    expected = {"B1": 2.0, "B2": 2.0, "B3": 3.0, "B4": 3.0, "C1": 3.0}
    assert list(factors) == [expected[name.split(".")[1]] for name in NAMES]


def test_growth_that_was_imposed_is_found_from_the_frequencies() -> None:
    coefficients, _ = nominal_values(RIG)
    imposed = coefficients * shaft_factors(RIG, driver=1.1, driven=1.4)
    change = plane_frequencies(RIG, coefficients=imposed) / plane_frequencies(RIG, coefficients=coefficients)
    found = BearingGrowth.to_reach(RIG, change)
    assert (found.driver, found.driven) == pytest.approx((0.1, 0.4), abs=1e-5)
    assert np.abs(found.misfit).max() < 1e-8


def test_a_document_without_values_is_named() -> None:
    silent = copy.deepcopy(DOCUMENT)
    del silent["bearings"][2]["kyx"], silent["discs"][1]["unbalance"]
    with pytest.raises(ValueError, match=r"bearing\.B3\.kyx, disc\.D2\.unbalance"):
        nominal_values(parse_machine(silent))
