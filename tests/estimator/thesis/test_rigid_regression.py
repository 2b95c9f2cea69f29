"""The regression of Chapter 2 on noise-free and noisy responses, Methods I and II, Cases A to C."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.arrays import Complexes
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.response import response
from estimator.thesis.noise import multiplicative_noise
from estimator.thesis.regression import Scaling, solve
from estimator.thesis.rigid_regression import rigid_regression
from estimator.thesis.rigid_train import condensed, names, printed_train

TRAIN = printed_train()
CASES = {
    "I-A": ([150, 170, 200, 220], []),
    "I-B": ([100, 185, 240, 330], []),
    "I-C": (range(10, 2001, 10), []),
    "II-A": ([150, 170], [150, 170]),
    "II-B": ([100, 240], [100, 240]),
    "II-C": (range(20, 2001, 20), range(20, 2001, 20)),
}


def train_of(case: str) -> CondensedTrain:
    forward, backward = CASES[case]
    direction = [1.0] * len(forward) + [-1.0] * len(backward)
    return condensed(TRAIN, speed=np.array([*forward, *backward], dtype=float), direction=np.array(direction))


def response_of(train: CondensedTrain) -> Complexes:
    return response(train, coefficients=TRAIN.coefficients, excitations=TRAIN.unbalances)


def noisy_error(case: str, percent: float, seed: int) -> np.ndarray:
    train = train_of(case)
    noisy = multiplicative_noise(response_of(train), percent=percent, rng=np.random.default_rng(seed))
    return np.abs(solve(rigid_regression(train, noisy)).values / TRAIN.values - 1.0)


@pytest.mark.parametrize("case", CASES)
def test_noise_free_regression_gives_the_assumed_values(case: str) -> None:
    train = train_of(case)
    regression = rigid_regression(train, response_of(train))
    assert regression.names == names()
    assert regression.matrix.shape == (16 * train.speed.size, 50)
    assert solve(regression, scaling="norm").values == pytest.approx(TRAIN.values, rel=1e-9)
    assert solve(regression, scaling="thesis").values == pytest.approx(TRAIN.values, rel=1e-6)
    assert np.abs(solve(regression).residual).max() < 1e-9 * np.abs(regression.target).max()


@pytest.mark.parametrize("case", CASES)
def test_scaling_lowers_the_condition_number(case: str) -> None:
    train = train_of(case)
    regression = rigid_regression(train, response_of(train))
    before = solve(regression, scaling="none").condition_number_after
    thesis = solve(regression, scaling="thesis").condition_number_after
    norm = solve(regression, scaling="norm").condition_number_after
    assert norm < thesis < before
    assert norm < 1e-3 * thesis


@pytest.mark.parametrize("scaling", ["none", "thesis", "norm"])
def test_inverse_of_eq_2_16_does_not_need_scaling(scaling: Scaling) -> None:
    """Although the condition number of AᵀA is beyond double precision before scaling."""
    train = train_of("I-A")
    found = solve(rigid_regression(train, response_of(train)), scaling=scaling, method="inverse")
    assert found.condition_number_before**2 > 1e18
    assert found.values == pytest.approx(TRAIN.values, rel=1e-5)


def test_pseudo_inverse_fails_without_scaling_and_without_any_noise() -> None:
    train = train_of("II-C")
    regression = rigid_regression(train, response_of(train))
    unscaled = solve(regression, scaling="none", method="pseudo-inverse").values
    assert np.max(np.abs(unscaled / TRAIN.values - 1.0)) > 1.0
    assert solve(regression, scaling="norm", method="pseudo-inverse").values == pytest.approx(TRAIN.values, rel=1e-9)


def test_thesis_scales_the_last_eight_columns_by_the_mean_speed() -> None:
    regression = rigid_regression(train_of("I-B"), response_of(train_of("I-B")))
    assert regression.thesis_scale == pytest.approx(np.append(np.ones(42), np.full(8, 4 / (100 + 185 + 240 + 330))))


def test_columns_of_the_first_rows_by_hand() -> None:
    """[kʳ], [cʳ], [uʳ] of the x-equation at bearing 1 and of the y-equation at bearing 3, with 1/16 and +jω."""
    omega = 185.0
    train = condensed(TRAIN, speed=np.array([omega]), direction=np.array([1.0]))
    q = response_of(train)
    regression = rigid_regression(train, q)
    equations = regression.matrix[:8] + 1j * regression.matrix[8:]
    x, y = q[0, :4], q[0, 4:]
    of = {name: column for column, name in enumerate(regression.names)}
    assert equations[0, of["bearing.B1.kxy"]] == pytest.approx(y[0])
    assert equations[0, of["coupling.C.kxx"]] == pytest.approx((x[0] - 5 * x[1] + 5 * x[2] - x[3]) / 16)
    assert equations[0, of["coupling.C.k_phix"]] == pytest.approx(x[0] - x[1] + x[2] - x[3])
    assert equations[0, of["coupling.C.cxy"]] == pytest.approx(1j * omega * (y[0] - 5 * y[1] + 5 * y[2] - y[3]) / 16)
    assert equations[0, of["disc.D2.unbalance.real"]] == pytest.approx(-0.25 * omega**2)
    assert equations[6, of["coupling.C.kyx"]] == pytest.approx((5 * x[0] - 25 * x[1] + 25 * x[2] - 5 * x[3]) / 16)
    assert equations[6, of["bearing.B3.cyy"]] == pytest.approx(1j * omega * y[2])
    assert equations[6, of["disc.D3.unbalance.real"]] == pytest.approx(0.75j * omega**2)
    assert equations[0, of["bearing.B2.kxx"]] == 0.0


def test_rounding_a_sixteenth_to_0_062_biases_the_coupling_by_0_8_percent() -> None:
    """[kʳ] and [cʳ] as printed bias a noise-free estimate: 0.0625 / 0.062, and nothing else."""
    train = train_of("II-C")
    lateral = np.array([one.element == "coupling.C" and "phi" not in one.name for one in train.unknowns.coefficients])
    rounded = replace(train, left=np.where(lateral, 0.062 * 16 * train.left, train.left))
    found = solve(rigid_regression(rounded, response_of(train))).values / TRAIN.values
    assert found[:42] == pytest.approx(np.where(lateral, 0.0625 / 0.062, 1.0), rel=1e-7)
    assert found[42:] == pytest.approx(np.ones(8), rel=1e-7)


def test_one_factor_on_all_phasors_moves_the_unbalances_only() -> None:
    """The regression is homogeneous in the response except for the unbalances, which take up the factor."""
    train = train_of("II-B")
    found = solve(rigid_regression(train, 1.02 * response_of(train))).values / TRAIN.values
    assert found[:42] == pytest.approx(np.ones(42), rel=1e-8)
    assert found[42:] == pytest.approx(np.full(8, 1.02), rel=1e-8)


def test_noise_of_the_thesis_costs_far_more_than_printed() -> None:
    """Method II, Case C: 0.01 % and 0.07 % printed for 1 % and 5 % noise."""
    one = np.median([noisy_error("II-C", 1.0, seed).max() for seed in range(5)])
    five = np.median([noisy_error("II-C", 5.0, seed).max() for seed in range(5)])
    assert 0.02 < one < 0.15
    assert 0.1 < five < 0.6


def test_four_speeds_leave_nothing_of_the_weakest_parameters_at_1_percent_noise() -> None:
    """Method I, Case A: 3.69 % printed."""
    assert np.median([noisy_error("I-A", 1.0, seed).max() for seed in range(5)]) > 10


def test_too_few_speeds() -> None:
    train = condensed(TRAIN, speed=np.array([100.0, 200, 300]), direction=np.ones(3))
    with pytest.raises(ValueError, match="48 equations cannot determine 50 unknowns"):
        solve(rigid_regression(train, response_of(train)))


def test_wrong_shape_is_named() -> None:
    train = train_of("I-A")
    with pytest.raises(ValueError, match=r"\(4, 7\), should have \(4, 8\)"):
        rigid_regression(train, response_of(train)[:, :7])
