"""Tests what is allowed at a coupling: usual over speed, or as the document says; and how probably a change is beyond it."""

import math
from typing import Any

import pytest
from pydantic import ValidationError

from estimator.alignment.alignment_change import AlignmentChange
from estimator.alignment.tolerance import allowed_alignment, tolerated_changes
from estimator.errors import Invalid
from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.checks.plausibility import implausible_values
from estimator.machine.document import Machine, parse_machine
from tests.estimator.statics.films import motor_compressor_document


def machine(rpm: float, **operation: Any) -> Machine:
    said = motor_compressor_document("flexible", "aligned")
    said["operation"] = {"running_rpm": rpm, **operation}
    said["speed_range"] = {"minimum_rpm": 300, "maximum_rpm": 9000}
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal"}
    return parse_machine(said)


def change(value: float, error: float, name: str = "coupling.C1.offset_vertical") -> AlignmentChange:
    return AlignmentChange(name, "m", value, error, 200e-6)


@pytest.mark.parametrize(
    ("rpm", "offset", "angle"),
    [(500, 190e-6, 1.3e-3), (1500, 90e-6, 0.7e-3), (3000, 60e-6, 0.4e-3), (3600, 50e-6, 0.371e-3), (8000, 30e-6, 0.3e-3)],
)
def test_usual_limits_fall_with_speed(rpm: float, offset: float, angle: float) -> None:
    found = allowed_alignment(machine(rpm), "C1")
    assert found.offset == pytest.approx(offset, rel=2e-3)
    assert found.angle == pytest.approx(angle, rel=2e-3)
    assert (found.rpm, found.stated) == (rpm, frozenset())


def test_the_document_comes_first() -> None:
    found = allowed_alignment(machine(3000, alignment_tolerances=[{"coupling": "C1", "offset": 25e-6}]), "C1")
    assert (found.offset, found.stated) == (25e-6, frozenset({"offset"}))
    assert found.angle == pytest.approx(0.4e-3)


def test_beyond_is_a_probability() -> None:
    train = machine(3000)
    at, far, near = tolerated_changes(train, [change(60e-6, 5e-6), change(-80e-6, 10e-6), change(30e-6, 10e-6)])
    assert at.beyond == pytest.approx(0.5)
    assert far.beyond == pytest.approx(0.5 * math.erfc(-2.0 / math.sqrt(2.0)), rel=1e-6)
    assert near.beyond < 0.002
    assert near.part == pytest.approx(0.5)
    assert far.part == pytest.approx(80 / 60)


def test_what_is_not_determined_is_beyond_nothing() -> None:
    (found,) = tolerated_changes(machine(3000), [change(500e-6, 190e-6)])
    assert (found.value, found.beyond, found.part) == (None, 0.0, 0.0)
    assert found.reason is not None


@pytest.mark.parametrize(
    ("tolerance", "where", "what"),
    [
        ({"coupling": "C1", "offset": 0}, "alignment_tolerances", "greater than 0"),
        ({"coupling": "C1", "angle": -1e-4}, "alignment_tolerances", "greater than 0"),
        ({"coupling": "C1", "offset": 50}, "alignment_tolerances", "was 50 µm meant, 5e-05?"),
        ({"coupling": "C1", "offset": 0.05}, "alignment_tolerances", "was 0.05 mm meant, 5e-05?"),
        ({"coupling": "C1", "angle": 300}, "alignment_tolerances", "was 300 µrad meant, 0.0003?"),
        ({"coupling": "C1", "angle": math.inf}, "alignment_tolerances", "finite"),
        ({"coupling": "C1"}, "alignment_tolerances", "neither offset"),
        ({"coupling": "C7", "offset": 5e-5}, "alignment_tolerances", "'C7' is not one of the couplings: C1"),
    ],
)
def test_tolerances_that_mean_nothing_are_refused(tolerance: dict[str, Any], where: str, what: str) -> None:
    with pytest.raises((Invalid, ValidationError)) as refused:
        machine(3000, alignment_tolerances=[tolerance])
    assert where in str(refused.value)
    assert what in str(refused.value)


@pytest.mark.parametrize(
    ("tolerance", "refused", "warned"),
    [
        ({"coupling": "C1", "offset": 1e-9}, "offset: 1e-09 m: no coupling stays aligned within less than 1 µm", ""),
        ({"coupling": "C1", "angle": 1e-8}, "angle: 1e-08 rad: no coupling stays aligned within less than 1 µrad", ""),
        ({"coupling": "C1", "offset": 2e-6}, "", "offset: 2e-06 m: growth from cold to hot alone passes it"),
        ({"coupling": "C1", "offset": 5e-3}, "", "offset: 0.005 m: no alarm would come in time"),
        ({"coupling": "C1", "offset": 5e-5, "angle": 4e-4}, "", ""),
    ],
)
def test_tolerances_that_are_hardly_meant(tolerance: dict[str, Any], refused: str, warned: str) -> None:
    train = machine(3000, alignment_tolerances=[tolerance])
    where = "operation.alignment_tolerances[0]."
    odd = "\n".join(f"{field}: {words}" for field, words in implausible_values(train) if field.startswith(where))
    said = "\n".join(str(one) for one in document_warnings(train) if one.field.startswith(where))
    assert odd.startswith(where + refused if refused else "")
    assert bool(odd) == bool(refused)
    assert said.startswith(where + warned if warned else "")
    assert bool(said) == bool(warned or refused)
