"""Balancing: against the dense model with the correction put in, optimality found by trying, and Monte Carlo."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from estimator.balancing.model_balancing import (
    Correction,
    balance,
    correction_masses,
    influence_coefficients,
    least_squares_within,
)
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from tests.estimator.models import draws, model_of
from tests.estimator.trains import chapter_3, chapter_3_document, dense_response, few_examples, mirrored

SPEED = np.array([80.0, 150.0, 240.0])
ALL = ("D1", "D2", "D3", "D4")


def corrected(document: dict[str, Any], correction: Correction) -> Machine:
    """The machine with the masses attached."""
    for plane, added in zip(correction.planes, correction.unbalance, strict=True):
        disc = next(one for one in document["discs"] if one["id"] == plane)
        angle = np.deg2rad(disc["unbalance"]["angle_deg"])
        whole = disc["unbalance"]["magnitude"] * np.exp(1j * angle) + added
        disc["unbalance"] = {"magnitude": float(abs(whole)), "angle_deg": float(np.rad2deg(np.angle(whole)))}
    return parse_machine(document)


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_what_is_predicted_is_what_the_masses_do(turned: bool) -> None:
    document = mirrored(chapter_3_document()) if turned else chapter_3_document()
    machine = parse_machine(document)
    found = balance(model_of(machine), planes=("D1", "D3"), speed=SPEED)
    assert found.before.value == pytest.approx(dense_response(machine, SPEED, direction=machine.direction), rel=1e-8)
    with_masses = corrected(document, found)
    expected = dense_response(with_masses, SPEED, direction=machine.direction)
    assert found.after.value == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.abs(expected).max())
    assert np.linalg.norm(expected) < 0.9 * np.linalg.norm(found.before.value)


def test_influence_is_the_response_to_a_unit_of_unbalance() -> None:
    document = chapter_3_document()
    for disc in document["discs"]:
        disc["unbalance"] = {"magnitude": 1.0 if disc["id"] == "D2" else 0.0, "angle_deg": 0.0}
    expected = dense_response(parse_machine(document), SPEED, direction=1)
    found = influence_coefficients(model_of(chapter_3()), planes=("D4", "D2"), speed=SPEED)
    assert found[:, :, 1] == pytest.approx(expected, rel=1e-8)


def test_all_planes_take_every_unbalance_away() -> None:
    model = model_of(chapter_3())
    found = balance(model, planes=ALL, speed=SPEED)
    assert found.unbalance == pytest.approx(-model.excitations, rel=1e-6)
    assert np.abs(found.after.value).max() < 1e-8 * np.abs(found.before.value).max()


@pytest.mark.parametrize("planes", [("D1",), ("D2", "D3"), ("D1", "D3", "D4")])
def test_as_many_planes_as_channels_bring_these_to_rest(planes: tuple[str, ...]) -> None:
    model = model_of(chapter_3())
    channels = model.machine.channels[:: len(model.machine.channels) // len(planes)][: len(planes)]
    found = balance(model, planes=planes, speed=np.array([130.0]), channels=channels)
    assert found.after.value.shape == (1, len(planes))
    assert np.abs(found.after.value).max() < 1e-8 * np.abs(found.before.value).max()


def test_no_other_correction_leaves_less() -> None:
    model = model_of(chapter_3())
    weight = np.random.default_rng(1).uniform(0.5, 2.0, (SPEED.size, 8))
    limit = np.array([2e-3, np.inf])
    for limits in (None, limit):
        found = balance(model, planes=("D1", "D4"), speed=SPEED, weight=weight, limit=limits)
        influence = influence_coefficients(model, planes=("D1", "D4"), speed=SPEED)

        def cost(unbalance: np.ndarray, influence: np.ndarray = influence, before: np.ndarray = found.before.value) -> float:
            return float(np.sum(np.abs(weight * (before + influence @ unbalance)) ** 2))

        least = cost(found.unbalance)
        assert cost(np.zeros(2)) > least
        rng = np.random.default_rng(2)
        for _ in range(300):
            other = found.unbalance + 1e-4 * (rng.standard_normal(2) + 1j * rng.standard_normal(2))
            if limits is not None:
                other *= np.minimum(1.0, limits / np.abs(other))
            assert cost(other) >= least * (1 - 1e-9)
    assert abs(found.unbalance[0]) == pytest.approx(2e-3), "that limit holds"


@few_examples
@given(st.integers(1, 4), st.integers(0, 1000), st.floats(0.01, 3.0))
def test_limited_least_squares_meets_its_conditions(planes: int, seed: int, size: float) -> None:
    """Karush, Kuhn and Tucker: inside, the gradient is zero; on the limit, it points straight outwards."""
    rng = np.random.default_rng(seed)
    matrix = rng.standard_normal((8, planes)) + 1j * rng.standard_normal((8, planes))
    target = rng.standard_normal(8) + 1j * rng.standard_normal(8)
    limit = size * rng.uniform(0.1, 1.0, planes)
    found = least_squares_within(matrix, target, limit)
    assert np.all(np.abs(found) <= limit * (1 + 1e-12))
    gradient = np.conj(matrix).T @ (matrix @ found - target)
    for c, slope, most in zip(found, gradient, limit, strict=True):
        if abs(c) < most * (1 - 1e-6):
            assert abs(slope) < 1e-4 * np.linalg.norm(target)
        else:
            # What is left of the gradient pulls along c, outwards.
            assert (slope / c).real < 1e-4
            assert abs((slope / c).imag) * most < 1e-4 * np.linalg.norm(target)


def test_a_limit_of_zero_leaves_a_plane_alone() -> None:
    model = model_of(chapter_3())
    found = balance(model, planes=("D1", "D4"), speed=SPEED, limit=np.array([0.0, 1.0]))
    alone = balance(model, planes=("D4",), speed=SPEED)
    assert found.unbalance[0] == 0.0
    assert found.unbalance[1] == pytest.approx(alone.unbalance[0], rel=1e-5)


def test_a_weight_of_zero_forgets_a_channel() -> None:
    model = model_of(chapter_3())
    weight = np.ones((SPEED.size, 8))
    weight[:, 1:] = 0.0
    found = balance(model, planes=("D2",), speed=SPEED, weight=weight)
    assert found.unbalance == pytest.approx(
        balance(model, planes=("D2",), speed=SPEED, channels=model.machine.channels[:1]).unbalance, rel=1e-9
    )


def test_twice_the_unbalance_needs_twice_the_correction() -> None:
    model = model_of(chapter_3())
    doubled = np.where(["unbalance" in name for name in model.coordinates], 2.0, 1.0)
    twice = structs.replace(model, values=doubled * model.values)
    one, other = (balance(of, planes=("D1", "D3"), speed=SPEED) for of in (model, twice))
    assert other.unbalance == pytest.approx(2 * one.unbalance, rel=1e-9)
    assert other.after.value == pytest.approx(2 * one.after.value, rel=1e-6)


def test_what_is_left_is_as_uncertain_as_monte_carlo_says() -> None:
    """1500 draws: a mean square within some 5 %, a 97.5 % quantile within 5 %. All planes: only uncertainty is left."""
    model = model_of(chapter_3(), error=0.01)
    found = balance(model, planes=ALL, speed=SPEED)
    train = condense(chapter_3(), speed=SPEED, direction=np.ones(SPEED.size))
    cloud = np.array([response(train, coefficients=c, excitations=u + found.unbalance) for c, u in draws(model, 1500)])
    mean_square = np.trace(found.after.covariance, axis1=-2, axis2=-1)
    assert np.mean(np.abs(cloud) ** 2, axis=0) == pytest.approx(mean_square, rel=0.25)
    assert np.quantile(np.abs(cloud), 0.975, axis=0) == pytest.approx(found.after.upper, rel=0.15)
    assert np.all(found.after.upper < found.before.lower)


def test_masses_of_a_correction() -> None:
    found = balance(model_of(chapter_3()), planes=("D1", "D2"), speed=SPEED)
    turned = replace(found, unbalance=np.array([1e-3 * np.exp(-0.5j * np.pi), 2e-4 + 0j]))
    one, other = correction_masses(turned, radius=[0.1, 0.05])
    assert (one.plane, other.plane) == ("D1", "D2")
    assert (one.grams, one.angle_deg) == pytest.approx((10.0, 270.0))
    assert (other.grams, other.angle_deg) == pytest.approx((4.0, 0.0))
    with pytest.raises(ValueError, match="positive radius"):
        correction_masses(found, radius=[0.1, 0.0])


def test_planes_that_do_the_same_are_recognised_by_the_condition_number() -> None:
    document = chapter_3_document()
    document["discs"].append(document["discs"][0] | {"id": "D5", "station": 0.26})
    model = model_of(parse_machine(document))
    numbers = [balance(model, planes=planes, speed=SPEED).condition_number for planes in (("D1",), ("D1", "D3"), ("D1", "D5"))]
    assert numbers[0] == pytest.approx(1.0)
    assert numbers[1] < 10.0
    assert numbers[2] > 30.0


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"planes": ("D9",)}, "'D9' is not one of the planes: D1, D2, D3, D4"),
        ({"planes": ("D1", "D1")}, "planes must be named once each"),
        ({"planes": ()}, "at least one"),
        ({"channels": ("nowhere",)}, "'nowhere' is not one of the channels"),
        ({"weight": np.ones((1, 1))}, "weight must hold 3 × 8 numbers"),
        ({"limit": np.array([-1.0])}, "limit must hold 1 numbers that are not negative"),
    ],
)
def test_wrong_input_is_named(changed: dict[str, Any], message: str) -> None:
    asked: dict[str, Any] = {"planes": ("D1",), "speed": SPEED}
    with pytest.raises(ValueError, match=message):
        balance(model_of(chapter_3()), **(asked | changed))
