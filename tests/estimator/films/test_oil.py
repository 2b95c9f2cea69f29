"""Viscosity of oils over temperature."""

import numpy as np
import pytest

from estimator.films.oil import InvalidOil, WaltherOil, grade_oil


def test_a_grade_has_its_viscosity_at_40_and_at_100_degrees() -> None:
    found = grade_oil(46).viscosity(np.array([40.0, 100.0]))
    density = 870.0 * (1 - 6.5e-4 * np.array([25.0, 85.0]))
    assert found == pytest.approx(np.array([46.0, 6.8]) * 1e-6 * density, rel=1e-12)


def test_between_them_it_is_straight_in_the_coordinates_of_astm_d341() -> None:
    oil = WaltherOil(32.0, 5.4)
    temperature = np.array([40.0, 55.0, 80.0, 100.0])
    kinematic = oil.viscosity(temperature) / (870.0 * (1 - 6.5e-4 * (temperature - 15.0))) * 1e6
    across, up = np.log10(temperature + 273.15), np.log10(np.log10(kinematic + 0.7))
    slope = np.diff(up) / np.diff(across)
    assert np.ptp(slope) < 1e-9
    assert -4.0 < slope[0] < -3.4  # of mineral oils


def test_warmer_oil_is_thinner_at_the_rate_of_its_slope() -> None:
    oil, temperature = grade_oil(68), np.linspace(10.0, 120.0, 12)
    step = 1e-3
    differences = (oil.viscosity(temperature + step) - oil.viscosity(temperature - step)) / (2 * step)
    assert oil.slope(temperature) == pytest.approx(differences, rel=1e-7)
    assert (oil.slope(temperature) < 0.0).all()
    # Around 50 °C a common turbine oil loses some 4 % of its viscosity for each kelvin.
    assert oil.slope(50.0) / oil.viscosity(50.0) == pytest.approx(-0.042, abs=0.005)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: grade_oil(47), r"no ISO VG grade 47: there are 10, 15, .*680; others need"),
        (lambda: WaltherOil(46.0, 68.0), "100 °C must be the smaller"),
        (lambda: WaltherOil(46.0, 6.8, 0.87), "oils have 800 to 1000"),
        (lambda: grade_oil(46).viscosity(323.0), "in another unit"),
        (lambda: grade_oil(46).slope(np.array([40.0, np.nan])), "outside -20 to 180"),
    ],
)
def test_what_no_oil_has_is_refused(made: object, said: str) -> None:
    assert callable(made)
    with pytest.raises(InvalidOil, match=said):
        made()


def test_another_grade_needs_its_second_viscosity() -> None:
    assert grade_oil(37, viscosity_at_100=6.0).viscosity(100.0) == pytest.approx(6e-6 * 870.0 * (1 - 6.5e-4 * 85.0))
