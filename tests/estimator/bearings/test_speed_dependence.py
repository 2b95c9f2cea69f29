"""Coefficients that follow the speed, against full solves with the coefficients of each speed."""

import copy
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from estimator.bearings.knots import piecewise_weights, polynomial_weights
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.machine.parameter_description import is_direct
from estimator.phasors.measurement import Measurement
from estimator.trends.between_run_scatter import DAMPING_SCATTER, STIFFNESS_SCATTER, expected_scatter, sizes
from tests.estimator.full_train import deviations, elements, full_response, node_of, true_values
from tests.estimator.trains import Complexes, Document, Floats, chapter_3_document, noisy, perturbed

SPEED: Floats = np.arange(10.0, 300.0, 2.0)
KNOTS = [300.0, 1200.0, 2600.0]
"""[r/min]: 31, 126, 272 rad/s."""
TrueFactor = Callable[[float, str], float]
"""Factor on bearing B2's nominal coefficient of that name at a speed [r/min]."""


def follows(form: str, coefficients: list[str] | None = None) -> Document:
    document = chapter_3_document()
    dependence: dict[str, Any] = {"form": form, "knots_rpm": KNOTS}
    if coefficients:
        dependence["coefficients"] = coefficients
    document["bearings"][1]["speed_dependence"] = dependence
    return document


def film(rpm: float, name: str) -> float:
    """Like an oil film's: stiffness grows with speed, damping falls; level below the first knot and above the last."""
    at = float(np.interp(rpm, KNOTS, [0.0, 1.0, 1.6]))
    direct = {"kxx": math.exp(0.3 * at), "kyy": math.exp(0.2 * at), "cxx": math.exp(-0.4 * at), "cyy": math.exp(-0.3 * at)}
    return direct.get(name, 1.0 + 0.4 * at)


def curved(rpm: float, name: str) -> float:
    """The logarithm of direct terms, and cross-coupled terms themselves, are parabolas in the speed."""
    part = rpm / 1000.0
    parabola = 0.3 * part - 0.07 * part**2
    return math.exp(parabola) if name in ("kxx", "kyy", "cxx", "cyy") else 1.0 + parabola


def stiffening(rpm: float, name: str) -> float:
    return film(rpm, name) if name == "kxx" else 1.0


def phasors(machine: Machine, truth: TrueFactor, direction: int = 1, speed: Floats = SPEED) -> Complexes:
    """Full solves, bearing B2's coefficients those of each speed."""
    bearing = machine.bearings[1]
    x = node_of(machine, bearing.shaft, bearing.station)
    stiffness, damping, mass = elements(machine)

    def more(kind: str, rpm: float) -> list[list[float]]:
        change = {a: getattr(bearing, kind + a) * (truth(rpm, kind + a) - 1.0) for a in ("xx", "xy", "yx", "yy")}
        return [[change["xx"], change["xy"]], [change["yx"], change["yy"]]]

    def at_speed(omega: float) -> tuple[Floats, Floats, Floats]:
        k, c = stiffness.copy(), damping.copy()
        k[x : x + 2, x : x + 2] += more("k", omega * 30 / math.pi)
        c[x : x + 2, x : x + 2] += more("c", omega * 30 / math.pi)
        return k, c, mass

    return full_response(machine, speed, direction=direction, at_speed=at_speed)


def at_knots(machine: Machine, truth: TrueFactor, names: list[str] | None = None) -> dict[str, complex]:
    """Return true values by the estimates' names: at the knots for B2, nominal ones for everything else."""
    values = true_values(machine)
    found: dict[str, complex] = {}
    for name, value in values.items():
        own = name.removeprefix("bearing.B2.")
        if own == name or (names and own not in names):
            found[name] = value
        else:
            found |= {f"{name}@{knot:g}rpm": value * truth(knot, own) for knot in KNOTS}
    return found


def assert_recovered(found: Identification, expected: dict[str, complex]) -> None:
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) < 5 * math.sqrt(2 / found.degrees_of_freedom)
    assert {one.name for one in found.estimates} == set(expected)
    own = {name: value for name, value in expected.items() if "@" in name}
    assert all(found.estimate(name).estimable for name in own if ".k" in name)
    assert np.abs(deviations(found, expected)).max() < 4.5
    assert np.abs(deviations(found, own)).max() < 4.0


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("form", "law"), [("piecewise", film), ("polynomial", curved)])
def test_coefficients_are_recovered_at_the_knots(form: str, law: TrueFactor, direction: int) -> None:
    machine = parse_machine(follows(form))
    clean = phasors(machine, law, direction)
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(clean, seed=11), direction=direction))
    assert_recovered(found, at_knots(machine, law))


def test_constant_model_is_refused() -> None:
    document = chapter_3_document()
    clean = phasors(parse_machine(document), film)
    third = slice(None, None, 3)
    found = identify(
        parse_machine(document), Measurement.of(speed=SPEED[third], phasor=noisy(clean, seed=11)[third]), Options(starts=1)
    )
    assert not found.accepted


def test_only_the_coefficients_named_follow() -> None:
    machine = parse_machine(follows("piecewise", ["kxx"]))
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(phasors(machine, stiffening), seed=2)))
    assert_recovered(found, at_knots(machine, stiffening, ["kxx"]))


def test_wrong_nominal_values() -> None:
    document = follows("piecewise")
    machine = parse_machine(document)
    clean = noisy(phasors(machine, film), seed=11)
    found = identify(parse_machine(perturbed(document, seed=1, span=0.4)), Measurement.of(speed=SPEED, phasor=clean))
    assert_recovered(found, at_knots(machine, film))


def test_piecewise_weights() -> None:
    weights = piecewise_weights(np.array([300.0, 900.0]), np.array([100.0, 300.0, 450.0, 900.0, 5000.0]))
    assert weights == pytest.approx(np.array([[1, 0], [1, 0], [0.75, 0.25], [0, 1], [0, 1]]))


def test_polynomial_weights_are_those_of_the_polynomial_through_the_knots() -> None:
    knots = np.array([300.0, 900.0, 1500.0, 3000.0])
    speed = np.linspace(200.0, 3200.0, 7)
    weights = polynomial_weights(knots, speed)
    values = np.array([1.0, -2.0, 0.5, 3.0])
    through = np.polynomial.Polynomial.fit(knots, values, 3)
    assert weights @ values == pytest.approx(through(speed), rel=1e-9)


def test_knot_that_no_data_reach_is_not_estimable() -> None:
    document = follows("piecewise")
    document["bearings"][1]["speed_dependence"]["knots_rpm"] = [300.0, 2600.0, 9000.0, 12000.0]
    machine = parse_machine(document)
    clean = full_response(machine, SPEED)
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(clean, seed=1)))
    assert found.accepted
    far = found.estimate("bearing.B2.kxx@12000rpm")
    assert not far.estimable
    assert "the data leave it uncertain" in (far.reason or "")
    assert found.estimate("bearing.B2.kxx@300rpm").estimable


@pytest.mark.parametrize(
    ("changes", "field", "message"),
    [
        ({"knots_rpm": [900.0, 300.0]}, "bearings[1].speed_dependence", "must ascend"),
        ({"knots_rpm": [300.0, 300.0]}, "bearings[1].speed_dependence", "must ascend"),
        ({"knots_rpm": [300.0]}, "bearings[1].speed_dependence.knots_rpm", "at least 2"),
        ({"form": "spline"}, "bearings[1].speed_dependence.form", "should be 'polynomial', 'piecewise'"),
        ({"coefficients": ["kzz"]}, "bearings[1].speed_dependence.coefficients", "kzz"),
        ({"coefficients": ["station"]}, "bearings[1].speed_dependence.coefficients", "station"),
        ({"coefficients": ["k_phix"]}, "bearings[1].speed_dependence.coefficients", "k_phix"),
    ],
)
def test_wrong_speed_dependence_names_the_field(changes: dict[str, Any], field: str, message: str) -> None:
    document = copy.deepcopy(follows("piecewise"))
    document["bearings"][1]["speed_dependence"].update(changes)
    with pytest.raises(DocumentError) as raised:
        parse_machine(document)
    assert [(place, message in words) for place, words in raised.value.problems] == [(field, True)]


def test_optional_coupling_term_that_is_not_given_cannot_follow() -> None:
    document = chapter_3_document()
    dependence = {"form": "piecewise", "knots_rpm": KNOTS, "coefficients": ["kx_phiy"]}
    document["couplings"][0]["speed_dependence"] = dependence
    with pytest.raises(DocumentError, match="kx_phiy"):
        parse_machine(document)
    document["couplings"][0]["kx_phiy"] = 1e3
    assert parse_machine(document).couplings[0].speed_dependence is not None


def test_a_knot_between_two_whole_speeds_leaves_a_parameter_what_it_is() -> None:
    names = ("bearing.B1.kxx@1500.5rpm", "bearing.B1.kyy@1500.5rpm", "bearing.B1.kxy@1500.5rpm", "bearing.B1.cxx@1500.5rpm")
    assert [is_direct(name) for name in names] == [True, True, False, True]
    assert expected_scatter(names).tolist() == [STIFFNESS_SCATTER, STIFFNESS_SCATTER, STIFFNESS_SCATTER, DAMPING_SCATTER]
    assert sizes(names, np.array([np.log(4.0), np.log(9.0), 0.5, 0.0])) == pytest.approx([1.0, 1.0, 6.0, 1.0])
