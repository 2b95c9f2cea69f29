"""The experiments of Chapter 2 as the evidence page runs them."""

import numpy as np
import pytest

from benchmarks.thesis.__main__ import main
from benchmarks.thesis.chapter_2.experiments import (
    bound,
    case,
    exact_phase_bound,
    experiment,
    likelihood,
    likelihood_values,
    regression,
    regression_errors,
)
from benchmarks.thesis.chapter_2.misprints import MISPRINTS, shifts
from benchmarks.thesis.chapter_2.printed import TABLE_2_8, TABLES_2_4_TO_2_7
from estimator.rotor.response import sensitivity
from estimator.thesis.noise import complex_noise
from estimator.thesis.rigid_train import names

BEST = experiment(case("II", "C"))


def test_bound_is_that_of_the_information_matrix() -> None:
    rms = 0.01
    found = sensitivity(BEST.train, coefficients=BEST.rigid.coefficients, excitations=BEST.rigid.unbalances)
    slope = (found.by_parameter / (rms * np.abs(found.phasor))[..., None]).reshape(-1, 50) * BEST.rigid.values
    information = 2.0 * (slope.conj().T @ slope).real
    assert bound(BEST, rms=rms) == pytest.approx(np.sqrt(np.diag(np.linalg.inv(information))), rel=1e-8)


def test_exact_phases_leave_a_common_factor_of_the_unbalances_only() -> None:
    """1600 amplitudes then average its noise."""
    errors, fixed = exact_phase_bound(BEST, rms=0.01)
    assert fixed == 49
    assert errors[:42].max() < 1e-12
    assert errors[42:] == pytest.approx(np.full(8, 0.01 / np.sqrt(1600)), rel=1e-6)


def test_exact_phases_never_raise_the_bound() -> None:
    """Noise along the phasor alone, of the same rms: twice the variance there, none across."""
    near = experiment(case("I", "A"))
    errors, fixed = exact_phase_bound(near, rms=0.01)
    assert fixed == 32
    assert np.all(errors <= np.sqrt(2.0) * bound(near, rms=0.01) * (1 + 1e-9))


def test_print_lies_far_below_any_unbiased_estimate_in_the_four_speed_cases() -> None:
    for method, name in (("I", "A"), ("I", "B"), ("II", "A"), ("II", "B")):
        for noise, printed in zip((1.0, 2.0, 5.0), TABLE_2_8[method, name].errors, strict=True):
            errors, _ = exact_phase_bound(experiment(case(method, name)), rms=noise / 100 / np.sqrt(12))
            assert 100 * errors.max() > 25 * printed


def test_maximum_likelihood_reaches_the_bound_and_the_regression_does_not() -> None:
    rms = 0.0144
    smallest = bound(BEST, rms=rms)
    ratios = []
    for seed in range(3):
        phasor = complex_noise(BEST.clean, rms=rms, rng=np.random.default_rng(seed))
        fitted = likelihood(BEST, phasor, rms=rms, seed=seed)
        assert fitted.accepted
        ratios.append([BEST.error(likelihood_values(fitted)), BEST.error(regression(BEST, phasor).values)])
    likely, regressed = np.sqrt(np.mean((np.array(ratios) / smallest) ** 2, axis=(0, 2)))
    assert 0.8 < likely < 1.2
    assert regressed > 5


def test_one_factor_for_all_cancels_in_the_coefficients() -> None:
    errors = regression_errors(BEST, 5.0, seeds=3, sharing="all")
    assert errors[:, :42].max() < 1e-9
    assert np.ptp(errors[:, 42:], axis=1).max() < 1e-9
    assert errors[:, 42:].max() > 1e-3


def test_misprints_that_move_single_unknowns_only() -> None:
    by_name = {item.name: shifts(BEST, item) for item in MISPRINTS}
    order = names()
    spring = by_name["data: 5/16 for 1/16 in K_44, K_88"]
    touched = {order[k] for k in np.flatnonzero(np.abs(spring) > 1e-6)}
    assert touched == {"bearing.B4.kxx", "bearing.B4.kyy"}
    assert spring[order.index("bearing.B4.kxx")] == pytest.approx(0.25 * 2.12e5 / 2.14e5, rel=1e-6)
    sign = by_name["regression: -jω for +jω"]
    assert sign[22:42] == pytest.approx(np.full(20, -2.0), rel=1e-6)
    weights = by_name["data: unbalance weights 1 and 0.5 of Eq. 2.9"]
    assert np.abs(weights[:42]).max() < 1e-6
    assert np.abs(weights[42:]).max() > 0.1


def test_printed_estimates_without_noise_are_biased() -> None:
    printed = np.array([TABLES_2_4_TO_2_7[name][:2] for name in names()])
    shift = printed[:, 1] / printed[:, 0] - 1
    assert shift[:16] == pytest.approx(np.full(16, 0.0098), abs=0.0004)
    assert shift[16:20] == pytest.approx(np.full(4, 0.0020), abs=0.0001)
    assert shift[20:22] == pytest.approx(np.full(2, 0.00055), abs=0.0001)


def test_one_experiment_from_the_command_line(capsys: pytest.CaptureFixture[str]) -> None:
    main(["chapter-2", "--method", "I", "--case", "B", "--noise", "0"])
    lines = capsys.readouterr().out.splitlines()
    assert sum(line.startswith(("| bearing.", "| coupling.", "| disc.")) for line in lines) == 50
    assert "| bearing.B1.kxx | 2.5e+05 | 2.5e+05 |" in "\n".join(lines)
    assert "condition number: 5.89e+09 before, 4.12e+02 after" in lines[-1]


def test_a_choice_that_makes_no_sense_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["chapter-2", "--solver", "inverse", "--tikhonov", "L-curve"])
    assert "orthogonal method only" in capsys.readouterr().err
