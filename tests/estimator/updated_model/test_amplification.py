"""Amplification factors and margins: the unbalance response of one mass in closed form, and the standard's own bounds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.parts import Probe
from estimator.updated_model.amplification import (
    HALF_POWER,
    Peak,
    SpeedPosition,
    amplification,
    required_margin,
    response_peaks,
    separation_margin,
)
from tests.estimator.models import model_of
from tests.estimator.rigid_rotor import bounce, rigid_rotor
from tests.estimator.trains import Floats, chapter_3, dense_response, few_examples


def one_mass(ratio: Floats, damping: float) -> Floats:
    """r² / √((1 - r²)² + (2ζr)²)."""
    return np.asarray(ratio**2 / np.sqrt((1 - ratio**2) ** 2 + (2 * damping * ratio) ** 2))


def closed_form(damping: float) -> tuple[float, float, float, float]:
    """Place and height of the top, and where the curve has 1/√2 of it (the upper place may not exist)."""
    top = 1 / math.sqrt(1 - 2 * damping**2)
    height = 1 / (2 * damping * math.sqrt(1 - damping**2))
    # s² (1 - 1/h²) - s (2 - 4ζ²) + 1 = 0 for s = r², h the level.
    level = height * HALF_POWER
    roots = np.roots([1 - 1 / level**2, -(2 - 4 * damping**2), 1.0])
    lower, upper = np.sqrt(np.sort(roots.real))
    return top, height, float(lower), float(upper)


@few_examples
@given(st.floats(0.005, 0.15))
def test_one_mass_has_its_closed_form(damping: float) -> None:
    speed = np.unique(np.concatenate([np.linspace(0.05, 3.0, 400), 1 + damping * np.linspace(-6, 6, 49)]))
    speed = speed[speed > 0]
    (peak,) = response_peaks(speed, one_mass(speed, damping))
    top, height, lower, upper = closed_form(damping)
    assert peak.speed == pytest.approx(top, rel=1e-3)
    assert peak.amplitude == pytest.approx(height, rel=2e-3)
    assert peak.lower == pytest.approx(lower, rel=1e-3)
    assert peak.upper == pytest.approx(upper, rel=1e-3)
    assert peak.amplification_factor == pytest.approx(top / (upper - lower), rel=0.01)
    assert not peak.one_sided


def test_light_damping_amplifies_by_half_its_inverse() -> None:
    top, _, lower, upper = closed_form(0.01)
    assert Peak(top, 1.0, lower, upper).amplification_factor == pytest.approx(1 / (2 * 0.01), rel=2e-3)


def test_heavy_damping_never_falls_to_the_level_above_its_top() -> None:
    """ζ = 0.4: the top is 1.36, and the response tends to 1, more than 0.707 of it."""
    speed = np.linspace(0.05, 20.0, 2000)
    (peak,) = response_peaks(speed, one_mass(speed, 0.4))
    assert peak.upper is None
    assert peak.one_sided
    assert peak.lower is not None
    assert peak.amplification_factor == pytest.approx(peak.speed / (2 * (peak.speed - peak.lower)))


def test_two_peaks_keep_apart() -> None:
    speed = np.linspace(0.3, 3.0, 3000)
    far = one_mass(speed, 0.02) + one_mass(speed / 2, 0.02)
    first, second = response_peaks(speed, far)
    assert first.speed == pytest.approx(1.0, abs=0.01)
    assert second.speed == pytest.approx(2.0, abs=0.02)
    assert first.upper is not None
    assert first.upper < 1.2
    assert second.lower is not None
    assert second.lower > 1.8


def test_a_low_peak_on_the_flank_of_a_high_one_has_no_lower_speed() -> None:
    """The level of the low one is reached again only on the far side of the high one."""
    speed = np.linspace(0.5, 2.0, 3000)
    curve = np.exp(-(((speed - 1.0) / 0.2) ** 2)) + 0.45 * np.exp(-(((speed - 1.25) / 0.05) ** 2))
    high, low = response_peaks(speed, curve)
    assert high.speed == pytest.approx(1.0, abs=0.01)
    assert low.speed == pytest.approx(1.24, abs=0.02)
    valley = curve[(speed > high.speed) & (speed < low.speed)].min()
    assert HALF_POWER * low.amplitude < valley
    assert low.lower is None
    assert low.upper is not None
    assert low.one_sided
    assert high.lower is not None


def test_a_curve_without_peak_has_none() -> None:
    speed = np.linspace(1.0, 2.0, 50)
    assert response_peaks(speed, speed**2) == ()


@pytest.mark.parametrize(
    ("factor", "position", "required"),
    [
        (2.49, "below", None),
        (2.5, "below", 0.0),
        (2.5, "above", 10.0),
        (5.0, "below", 17 * (1 - 1 / 3.5)),
        (5.0, "above", 10 + 17 * (1 - 1 / 3.5)),
        (1000.0, "below", 16.0),
        (1000.0, "above", 26.0),
        (1000.0, "within", None),
    ],
)
def test_required_margins(factor: float, position: SpeedPosition, required: float | None) -> None:
    assert required_margin(factor, position=position) == (None if required is None else pytest.approx(required))


def sharp(speed: float) -> Peak:
    """AF = 10: 12 % required below the minimum speed, 22 % above the maximum continuous speed: 17 (1 - 1/8.5) = 15."""
    return Peak(speed=speed, amplitude=1.0, lower=0.95 * speed, upper=1.05 * speed)


@pytest.mark.parametrize(
    ("speed", "position", "actual", "met"),
    [
        (2540.0, "below", 100 * 460 / 3000, True),
        (2560.0, "below", 100 * 440 / 3000, False),
        (3500.0, "within", 0.0, False),
        (4990.0, "above", 100 * 990 / 4000, False),
        (5010.0, "above", 100 * 1010 / 4000, True),
    ],
)
def test_margins_of_a_peak(speed: float, position: str, actual: float, met: bool) -> None:
    found = separation_margin(sharp(speed), minimum_speed=3000.0, maximum_continuous_speed=4000.0)
    assert (found.position, found.met) == (position, met)
    assert found.actual == pytest.approx(actual)


def test_a_critically_damped_peak_may_lie_anywhere() -> None:
    flat = Peak(speed=3500.0, amplitude=1.0, lower=2500.0, upper=4500.0)
    assert separation_margin(flat, minimum_speed=3000.0, maximum_continuous_speed=4000.0).met is True


def test_a_peak_without_factor_is_not_judged() -> None:
    found = separation_margin(Peak(3500.0, 1.0, None, None), minimum_speed=3000.0, maximum_continuous_speed=4000.0)
    assert found.met is None
    assert found.required is None


def test_rigid_rotor_has_the_factor_of_its_damping() -> None:
    """Bounce with ζ = c / √(2km); the disc's unbalance in the middle moves nothing else."""
    machine = rigid_rotor(diametral=0.05, polar=0.03, damping=50.0)
    ratio = 50.0 / 5.0 / bounce()
    ((found,),) = amplification(
        model_of(machine),
        places=[Probe(id="P", shaft="S", station=0.05, angle_deg=30.0)],
        lowest=20.0,
        highest=400.0,
        minimum_speed=250.0,
        maximum_continuous_speed=300.0,
    )
    top, _, lower, upper = closed_form(ratio)
    assert found.peak.speed == pytest.approx(top * bounce(), rel=1e-3)
    assert found.peak.amplification_factor == pytest.approx(top / (upper - lower), rel=0.01)
    assert found.position == "below"
    assert found.actual == pytest.approx(100 * (1 - top * bounce() / 250.0), rel=1e-2)


def test_peaks_of_a_train_are_those_of_its_dense_response() -> None:
    machine = chapter_3()
    probe = machine.probes[2]
    (found,) = amplification(
        model_of(machine), places=[probe], lowest=20.0, highest=400.0, minimum_speed=250.0, maximum_continuous_speed=260.0
    )
    speed = np.linspace(20.0, 400.0, 3801)
    curve = np.abs(dense_response(machine, speed, direction=1)[:, 2])
    tops = speed[1:-1][(curve[1:-1] > curve[:-2]) & (curve[1:-1] > curve[2:])]
    assert [one.peak.speed for one in found] == pytest.approx(tops, abs=0.1)
    assert len(found) >= 3


def test_speeds_must_make_sense() -> None:
    for lowest, highest, minimum, maximum in ((0.0, 1.0, 1.0, 1.0), (2.0, 1.0, 1.0, 1.0), (1.0, 2.0, 3.0, 2.0)):
        with pytest.raises(ValueError, match="speeds must be positive"):
            amplification(
                model_of(chapter_3()),
                places=chapter_3().probes[:1],
                lowest=lowest,
                highest=highest,
                minimum_speed=minimum,
                maximum_continuous_speed=maximum,
            )
