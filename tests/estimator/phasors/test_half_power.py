"""Half-power points against the single degree of freedom in closed form, and the errors for curves that do not reach them."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from estimator.machine.document import parse_machine
from estimator.phasors.half_power import ExcitationKind, HalfPowerNotReached, half_power_points, outside, peak_samples
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from tests.estimator.trains import one_disc_document, truth

Floats = NDArray[np.float64]
NATURAL = 240.0
EXCITATIONS: tuple[ExcitationKind, ...] = ("unbalance", "constant force")


def amplitude(speed: Floats, ratio: float, excitation: ExcitationKind) -> Floats:
    """|1/(1 - r² + 2jζr)|, times r² under unbalance."""
    r = speed / NATURAL
    curve = 1.0 / np.abs(1.0 - r**2 + 2j * ratio * r)
    return np.asarray(curve * r**2 if excitation == "unbalance" else curve)


@pytest.mark.parametrize("excitation", EXCITATIONS)
@pytest.mark.parametrize("ratio", [0.005, 0.05, 0.3])
def test_a_single_degree_of_freedom_is_found_exactly_between_samples(excitation: ExcitationKind, ratio: float) -> None:
    """r² = 1 - 2ζ² and 1 - 2ζ² ± 2ζ√(1 - ζ²) under a constant force, their reciprocals under unbalance."""
    step = 0.3 * ratio * NATURAL
    speed = np.arange(0.3 * NATURAL + 0.37 * step, 3.0 * NATURAL, step)
    found = half_power_points(speed, amplitude(speed, ratio, excitation), excitation=excitation)
    middle, half = 1.0 - 2.0 * ratio**2, 2.0 * ratio * math.sqrt(1.0 - ratio**2)
    squares = np.array([middle - half, middle, middle + half])
    expected = NATURAL * (np.sqrt(squares) if excitation == "constant force" else 1.0 / np.sqrt(squares[::-1]))
    assert [found.lower, found.peak, found.upper] == pytest.approx(expected, rel=1e-9)
    assert found.amplitude == pytest.approx(1.0 / half, rel=1e-9)
    assert found.damping_ratio == pytest.approx(ratio, rel=1e-8)


def test_small_damping_is_half_the_relative_width() -> None:
    speed = np.linspace(200.0, 300.0, 2001)
    found = half_power_points(speed, amplitude(speed, 0.004, "unbalance"), excitation="unbalance")
    assert (found.upper - found.lower) / (2.0 * found.peak) == pytest.approx(0.004, rel=1e-3)


def test_a_jeffcott_rotor_shows_the_damping_at_its_disc() -> None:
    """The document's disc on a massless shaft between rigid bearings, damped at the disc: ζ = c/(2√(km))."""
    document = one_disc_document(density=1e-3, kxx=1e12, kyy=1e12, cxx=0.0001, cyy=0.0001, polar_inertia=0.0)
    length, diameter, mass = 1.0, 0.03, 5.0
    natural = math.sqrt(48 * 2.1e11 * math.pi / 64 * diameter**4 / length**3 / mass)
    damper = {"kxx": 1e-3, "kxy": 0.0, "kyx": 0.0, "kyy": 1e-3, "cxx": 2 * 0.03 * mass * natural, "cxy": 0.0, "cyx": 0.0}
    damper["cyy"] = damper["cxx"]
    document["bearings"].append({"id": "B3", "shaft": "S", "station": 0.5, **damper})
    machine = parse_machine(document)
    speed = np.linspace(0.5, 2.0, 120) * natural
    train = condense(machine, speed=speed, direction=np.ones(120))
    coefficients, unbalances = truth(machine)
    curve = np.abs(response(train, coefficients=coefficients, excitations=unbalances)[:, 0])
    found = half_power_points(speed, curve, excitation="unbalance")
    # Shear makes the shaft of the model a little softer than 48EI/L³.
    assert found.peak * math.sqrt(1 - 2 * 0.03**2) == pytest.approx(natural, rel=3e-3)
    assert found.damping_ratio == pytest.approx(0.03, rel=3e-3)


def two_peaks(speed: Floats) -> Floats:
    """Two separate resonances at 100 and 300 with damping ratios 0.01 and 0.02, the second twice as large."""
    first = 1.0 / np.abs(1.0 - (speed / 100.0) ** 2 + 0.02j * speed / 100.0)
    return np.asarray(first + 4.0 / np.abs(1.0 - (speed / 300.0) ** 2 + 0.04j * speed / 300.0))


def test_the_largest_peak_or_the_nearest_one() -> None:
    speed = np.linspace(50.0, 400.0, 3501)
    largest = half_power_points(speed, two_peaks(speed), excitation="constant force")
    assert largest.peak == pytest.approx(300.0, rel=1e-3)
    near = half_power_points(speed, two_peaks(speed), excitation="constant force", near=120.0)
    assert near.peak == pytest.approx(100.0, rel=1e-3)
    assert near.upper - near.lower < 4.0


def test_which_speeds_lie_outside() -> None:
    speed = np.linspace(50.0, 400.0, 3501)
    found = [half_power_points(speed, two_peaks(speed), excitation="constant force", near=one) for one in (100.0, 300.0)]
    asked = np.array([60.0, 98.0, 100.0, 102.0, 294.5, 299.0, 390.0])
    assert list(outside(asked, found)) == [True, True, False, True, False, False, True]
    assert outside(asked, []).all()


def test_the_points_themselves_are_inside() -> None:
    speed = np.linspace(150.0, 350.0, 401)
    found = half_power_points(speed, amplitude(speed, 0.05, "unbalance"), excitation="unbalance")
    assert not outside(np.array([found.lower, found.upper]), [found]).any()


@pytest.mark.parametrize(("first", "last", "side"), [(238.0, 350.0, "below"), (150.0, 243.0, "above")])
def test_a_curve_that_ends_too_early_says_on_which_side(first: float, last: float, side: str) -> None:
    speed = np.linspace(first, last, 500)
    with pytest.raises(HalfPowerNotReached, match=f"{side} the peak at .* widen the range"):
        half_power_points(speed, amplitude(speed, 0.05, "constant force"), excitation="constant force")


def test_a_shoulder_of_a_larger_peak_has_no_half_power_points() -> None:
    speed = np.linspace(50.0, 150.0, 1000)
    curve = 0.4 / np.abs(1 - (speed / 90) ** 2 + 0.08j) + 1.0 / np.abs(1 - (speed / 105) ** 2 + 0.08j)
    assert peak_samples(curve).size == 2
    with pytest.raises(HalfPowerNotReached, match="rises to a larger one"):
        half_power_points(speed, curve, excitation="constant force", near=90.0)


def test_a_peak_between_two_samples_is_sampled_too_coarsely() -> None:
    speed = np.array([100.0, 150.0, 239.0, 241.0, 330.0, 400.0])
    with pytest.raises(HalfPowerNotReached, match="sample more densely"):
        half_power_points(speed, amplitude(speed, 0.0001, "constant force"), excitation="constant force")


@pytest.mark.parametrize(
    ("speed", "curve", "message"),
    [
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0], "no peak between 1 and 3"),
        ([1.0, 3.0, 2.0], [1.0, 2.0, 1.0], "ascending"),
        ([0.0, 1.0, 2.0], [1.0, 2.0, 1.0], "positive"),
        ([1.0, 2.0, 3.0], [1.0, math.nan, 1.0], "amplitude must be positive and finite"),
        ([1.0, 2.0, 3.0], [0.0, 2.0, 1.0], "amplitude must be positive and finite"),
        ([1.0, 2.0], [1.0, 2.0], "three samples"),
    ],
)
def test_what_is_no_resonance_curve(speed: list[float], curve: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        half_power_points(np.array(speed), np.array(curve), excitation="unbalance")
