"""The regressions of Chapters 3 and 4: what they recover without noise, and what they cannot."""

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.rotor.rayleigh import RayleighCoefficients
from estimator.thesis.flexible_train import flexible_train, full_response, parts
from estimator.thesis.reduced_model import ReducedModel, reduced_response, response_equations
from estimator.thesis.reduction import eliminated, high_frequency_condensed
from estimator.thesis.regression import solve
from estimator.thesis.response_regression import (
    speed_dependent_regression,
    speed_independent_regression,
    with_trial_unbalances,
)
from tests.estimator.trains import chapter_3, truth

MACHINE = chapter_3()
TRAIN = flexible_train(MACHINE)
COEFFICIENTS, UNBALANCES = truth(MACHINE)
TRUTH = np.concatenate([COEFFICIENTS, parts(UNBALANCES)])

ONE_WAY_A = (np.array([100.0, 110.0]), np.array([1.0, 1.0]))
ONE_WAY_B = (np.array([60.0, 160.0]), np.array([1.0, 1.0]))
ONE_WAY_C = (np.arange(1.0, 301.0, 3.0), np.ones(100))
BOTH_WAYS_B = (np.array([160.0, 160.0]), np.array([1.0, -1.0]))
BOTH_WAYS_C = (np.tile(np.arange(2.0, 301.0, 6.0), 2), np.repeat([1.0, -1.0], 50))
BANDS = np.concatenate([np.arange(150.0, 175.1, 0.5), np.arange(275.0, 300.1, 0.5)])
"""Case C_fb3 of Chapter 4."""


def errors(model: ReducedModel, displacement: np.ndarray) -> Floats:
    """Relative error of every real unknown from the regression."""
    regression = speed_independent_regression(
        response_equations(model, displacement),
        TRAIN.unknowns,
        mean_speed=float(model.speed.mean()),
        damping_scaled=True,
    )
    return np.asarray(np.abs(solve(regression, scaling="norm").values / TRUTH - 1.0))


@pytest.mark.parametrize("case", [ONE_WAY_A, ONE_WAY_B, ONE_WAY_C, BOTH_WAYS_C])
@pytest.mark.parametrize("rayleigh", [None, RayleighCoefficients(mass_coefficient=1.5, stiffness_coefficient=1e-4)])
def test_interface_regression_recovers_the_truth(case: tuple[Floats, Floats], rayleigh: RayleighCoefficients | None) -> None:
    """Chapter 3 with the response of the full model, without noise: exact up to rounding."""
    speed, direction = case
    train = flexible_train(MACHINE, rayleigh=rayleigh)
    displacement = full_response(train, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=speed, direction=direction)
    model = eliminated(train, speed=speed, direction=direction)
    assert errors(model, displacement[:, train.interface]).max() < 1e-7


def test_both_ways_at_one_speed_does_not_determine_the_unknowns() -> None:
    """Method II, Cases A and B of Chapter 3: 64 equations, but of rank 46 only for 50 unknowns.

    An isotropic shaft that turns the other way is its own mirror image, so the second run repeats what the first one says
    about the unbalances.
    """
    speed, direction = BOTH_WAYS_B
    model = eliminated(TRAIN, speed=speed, direction=direction)
    displacement = reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES)
    regression = speed_independent_regression(
        response_equations(model, displacement), TRAIN.unknowns, mean_speed=160.0, damping_scaled=False
    )
    assert regression.matrix.shape == (64, 50)
    scaled = regression.matrix / np.linalg.norm(regression.matrix, axis=0)
    singular_values = np.linalg.svd(scaled, compute_uv=False)
    assert singular_values[45] > 1e-3
    assert np.all(singular_values[46:] < 1e-13)


def test_shaft_damping_that_the_model_lacks_biases_the_regression() -> None:
    speed, direction = BOTH_WAYS_C
    damped = flexible_train(MACHINE, rayleigh=RayleighCoefficients(mass_coefficient=1.5, stiffness_coefficient=1e-4))
    displacement = full_response(damped, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=speed, direction=direction)
    found = errors(eliminated(TRAIN, speed=speed, direction=direction), displacement[:, TRAIN.interface])
    assert found.max() > 0.05


@pytest.mark.parametrize("both_ways", [False, True])
def test_high_frequency_regression_recovers_the_truth_from_its_own_data(both_ways: bool) -> None:
    """Chapter 4, Case C_fb3, with data from the same reduced model. One way it is all but singular."""
    speed = np.tile(BANDS, 2) if both_ways else BANDS
    direction = np.repeat([1.0, -1.0], BANDS.size) if both_ways else np.ones(BANDS.size)
    model = high_frequency_condensed(TRAIN, speed=speed, direction=direction)
    own = reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES)
    assert errors(model, own).max() < (1e-9 if both_ways else 1e-7)


def test_high_frequency_regression_fails_on_the_response_of_the_full_model() -> None:
    """Chapter 4, Case C_fb3, Method I, without any noise: measured 332 % in the median, 8200 % at worst."""
    direction = np.ones(BANDS.size)
    displacement = full_response(TRAIN, coefficients=COEFFICIENTS, unbalances=UNBALANCES, speed=BANDS, direction=direction)
    found = errors(high_frequency_condensed(TRAIN, speed=BANDS, direction=direction), displacement[:, TRAIN.bearing])
    assert 3.0 < np.median(found) < 3.7
    assert 50.0 < found.max() < 120.0


@pytest.mark.parametrize("kind", ["interface", "high-frequency"])
def test_speed_dependent_regression_recovers_coefficients_that_change_with_speed(kind: str) -> None:
    """Three speeds, both ways, each with and without a known trial mass on each of two discs; data without noise."""
    trials = np.zeros((3, 4), dtype=complex)
    trials[1, 0], trials[2, 3] = 4e-3, 3e-3j
    runs = [(k, omega, sense, trial) for k, omega in enumerate((60.0, 160.0, 240.0)) for sense in (1, -1) for trial in trials]
    group = np.array([run[0] for run in runs])
    speed = np.array([run[1] for run in runs])
    direction = np.array([float(run[2]) for run in runs])
    trial = np.array([run[3] for run in runs])
    reduction = eliminated if kind == "interface" else high_frequency_condensed
    model = reduction(TRAIN, speed=speed, direction=direction)
    changing = COEFFICIENTS * (1.0 + 0.002 * (speed[:, None] - 60.0))
    displacement = reduced_response(model, coefficients=changing, unbalances=UNBALANCES + trial)
    equations = with_trial_unbalances(response_equations(model, displacement), trial)
    regression = speed_dependent_regression(equations, TRAIN.unknowns, group=group, mean_speed=float(speed.mean()))
    assert regression.matrix.shape[1] == 3 * 42 + 8
    assert regression.names[42] == f"{TRAIN.unknowns.coefficients[0].name}@1"
    expected = np.concatenate([changing[group == 0][0], changing[group == 1][0], changing[group == 2][0], parts(UNBALANCES)])
    found = solve(regression, scaling="norm").values
    assert np.abs(found / expected - 1.0).max() < 1e-8
    # One value for all speeds cannot say that: its residual is of the size of the change.
    constant = speed_independent_regression(equations, TRAIN.unknowns, mean_speed=150.0, damping_scaled=True)
    left_over = solve(constant, scaling="norm").residual
    assert np.linalg.norm(left_over) > 1e-3 * np.linalg.norm(constant.target)


def test_groups_must_be_numbered_without_gaps() -> None:
    speed, direction = ONE_WAY_B
    model = eliminated(TRAIN, speed=speed, direction=direction)
    equations = response_equations(model, reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES))
    with pytest.raises(ValueError, match="without gaps"):
        speed_dependent_regression(equations, TRAIN.unknowns, group=np.array([0, 2]), mean_speed=110.0)


def test_phasors_of_another_shape_are_refused() -> None:
    speed, direction = ONE_WAY_B
    model = eliminated(TRAIN, speed=speed, direction=direction)
    with pytest.raises(ValueError, match=r"\(2, 8\), should have \(2, 16\)"):
        response_equations(model, np.zeros((2, 8), dtype=complex))


def test_the_scaling_of_the_thesis() -> None:
    """§2.3.2 scales the unbalances, §4.5 the damping coefficients too, by 1/ω_a; the solution stays the same."""
    speed, direction = BOTH_WAYS_C
    model = eliminated(TRAIN, speed=speed, direction=direction)
    equations = response_equations(model, reduced_response(model, coefficients=COEFFICIENTS, unbalances=UNBALANCES))
    third = speed_independent_regression(equations, TRAIN.unknowns, mean_speed=200.0, damping_scaled=False)
    fourth = speed_independent_regression(equations, TRAIN.unknowns, mean_speed=200.0, damping_scaled=True)
    damping = np.array([one.quantity == "damping" for one in TRAIN.unknowns.coefficients])
    assert np.all(third.thesis_scale[:42] == 1.0)
    assert np.all(third.thesis_scale[42:] == 1 / 200.0)
    assert np.array_equal(fourth.thesis_scale[:42], np.where(damping, 1 / 200.0, 1.0))
    assert np.abs(solve(fourth, scaling="thesis").values / TRUTH - 1).max() < 1e-6
