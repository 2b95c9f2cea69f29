"""Targets of alignment: hot and cold kept apart, and documents that say them wrongly refused with what would be right."""

from typing import Any

import pytest

from estimator.alignment.targets import expected_alignment, targeted_alignment
from estimator.errors import Invalid
from estimator.updated_model.derived_quantities import Derived
from tests.estimator.alignment.test_tolerance import machine

COLD = {"offset_vertical": -100e-6, "angle_vertical": 50e-6}
TARGET = {"coupling": "C1", "left_cold": COLD, "growth": {"offset_vertical": 120e-6}}
TRAIN = machine(3000, alignment_targets=[TARGET])
"""Of which 60 µm are usually allowed."""


def offset(value: float | None, half: float = 0.0) -> Derived:
    name = "coupling.C1.offset_vertical"
    return (
        Derived(name, "m", None, None, None, "why") if value is None else Derived(name, "m", value, value - half, value + half)
    )


def test_hot_targets_are_the_cold_ones_with_their_growth() -> None:
    assert expected_alignment(TRAIN, "C1", "cold") == COLD
    assert expected_alignment(TRAIN, "C1", "hot") == {"offset_vertical": pytest.approx(20e-6)}
    assert expected_alignment(machine(3000), "C1", "cold") == {}


def test_a_run_is_compared_with_the_target_of_its_own_state() -> None:
    (hot,) = targeted_alignment(TRAIN, [offset(100e-6, half=20e-6)], "run-down")
    assert hot.state == "hot"
    assert hot.target == pytest.approx(20e-6)
    assert hot.off == pytest.approx(80e-6)
    assert hot.half == pytest.approx(20e-6)
    assert hot.beyond == pytest.approx(0.975, abs=1e-3)
    (cold,) = targeted_alignment(TRAIN, [offset(-100e-6, half=20e-6)], "run-up")
    assert (cold.state, cold.target, cold.off) == ("cold", -100e-6, 0.0)
    assert cold.beyond is not None
    assert cold.beyond < 1e-6
    assert targeted_alignment(TRAIN, [offset(0.0)], "mixed") == ()


def test_what_is_not_determined_is_not_beyond_anything() -> None:
    (one,) = targeted_alignment(TRAIN, [offset(None)], "run-up")
    assert (one.off, one.half, one.beyond, one.reason) == (None, None, None, "why")


@pytest.mark.parametrize(
    ("target", "message"),
    [
        ({"coupling": "C1", "left_cold": {}}, "neither an offset"),
        ({"coupling": "C1", "left_cold": {"offset_vertical": -120.0}}, "was -120 µm meant, -0.00012\\?"),
        ({"coupling": "C1", "left_cold": {"angle_vertical": 0.3}}, "was 0.3 mrad meant, 0.0003\\?"),
        (TARGET | {"growth": {"offset_horizontal": 1e-5}}, "left_cold does not say where it begins"),
        (TARGET | {"coupling": "C7"}, "'C7' is not one of the couplings: C1"),
        ({"coupling": "C1"}, "left_cold"),
    ],
)
def test_wrong_targets_are_refused(target: dict[str, Any], message: str) -> None:
    with pytest.raises(Invalid, match=message):
        machine(3000, alignment_targets=[target])


def test_two_targets_of_one_coupling_are_refused() -> None:
    with pytest.raises(Invalid, match="targets of coupling 'C1' stand here more than once"):
        machine(3000, alignment_targets=[TARGET, TARGET])
