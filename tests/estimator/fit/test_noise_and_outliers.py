"""Noise that nobody stated, phasors that are none, and what must be refused all the same. Data: full solves."""

import math

import numpy as np
import pytest

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import outlier_limit
from tests.estimator.full_train import full_response, true_values
from tests.estimator.trains import (
    Complexes,
    Document,
    Floats,
    chapter_3,
    chapter_3_document,
    dense_response,
    noisy,
    one_disc_document,
)

SPEED: Floats = np.arange(10.0, 300.0, 2.0)
CLEAN: Complexes = full_response(chapter_3(), SPEED)


def with_noise(**noise: float | bool) -> Machine:
    document: Document = chapter_3_document()
    document["noise"] = {"relative": 0.01, "floor": 0.0, **noise}
    return parse_machine(document)


def noisy_with_floor(clean: Complexes, *, relative: float, floor: float, seed: int) -> Complexes:
    rng = np.random.default_rng(seed)
    size = np.sqrt((relative * np.abs(clean)) ** 2 + floor**2) / math.sqrt(2)
    return np.asarray(clean + size * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)))


def median_error(found: Identification) -> float:
    """Median over the coefficients of |estimate - truth| / |truth|."""
    values = true_values(chapter_3())
    return float(
        np.median([abs((one.value or 0.0) - values[one.name]) / abs(values[one.name]) for one in found.estimates[:42]])
    )


def with_outliers(*, seed: int, part: float, whole_phase: bool) -> Complexes:
    """Noisy phasors of which a part is off: by 30 % in a random direction, or turned to any phase at all."""
    phasor = noisy(CLEAN, seed=seed)
    rng = np.random.default_rng(1000 + seed)
    hit = rng.random(phasor.shape) < part
    turn = np.exp(2j * math.pi * rng.random(phasor.shape))
    wrong = np.abs(phasor) * turn if whole_phase else phasor + 0.3 * np.abs(phasor) * turn
    return np.where(hit, wrong, phasor)


@pytest.mark.parametrize("start", [0.002, 0.1])
@pytest.mark.parametrize(("relative", "floor"), [(0.02, 5e-5), (0.005, 1e-4)])
def test_both_parts_of_the_noise_are_recovered(relative: float, floor: float, start: float) -> None:
    phasor = noisy_with_floor(CLEAN, relative=relative, floor=floor, seed=1)
    found = identify(with_noise(relative=start, estimated=True), Measurement.of(speed=SPEED, phasor=phasor))
    assert found.accepted, found.verdict
    assert found.noise.relative == pytest.approx(relative, rel=0.15)
    assert found.noise.floor == pytest.approx(floor, rel=0.15)
    stated = identify(with_noise(relative=relative, floor=floor), Measurement.of(speed=SPEED, phasor=phasor))
    for one in found.estimates:
        twin = stated.estimate(one.name)
        if one.standard_error is not None and twin.standard_error is not None:
            assert one.standard_error == pytest.approx(twin.standard_error, rel=0.15), one.name


def test_model_that_does_not_fit_is_refused_by_the_order_in_its_residuals() -> None:
    stiffer = chapter_3_document()
    stiffer["materials"]["steel"]["young_modulus"] *= 1.03
    phasor = noisy(full_response(parse_machine(stiffer), SPEED), seed=1)
    found = identify(with_noise(estimated=True), Measurement.of(speed=SPEED, phasor=phasor), Options(starts=1))
    assert not found.accepted
    assert found.verdict.startswith("the model does not fit the data: residuals of neighbouring speeds are alike")


@pytest.mark.parametrize("whole_phase", [False, True], ids=["30 % off", "any phase"])
def test_outliers_hardly_harm(whole_phase: bool) -> None:
    errors = []
    for seed in range(3):
        clean = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=seed)))
        phasor = with_outliers(seed=seed, part=0.05, whole_phase=whole_phase)
        found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor))
        assert found.accepted, found.verdict
        assert 0.03 * phasor.size < sum(found.outliers.values()) < 0.08 * phasor.size
        errors.append((median_error(found), median_error(clean)))
    found_error, clean_error = np.mean(errors, axis=0)
    assert found_error < 1.5 * clean_error


def test_whole_bad_channel_is_refused_and_named() -> None:
    phasor = noisy(CLEAN, seed=0)
    rng = np.random.default_rng(5)
    phasor[:, 4] = np.abs(phasor[:, 4]) * np.exp(2j * math.pi * rng.random(SPEED.size))
    found = identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor), Options(starts=2))
    assert not found.accepted
    assert "most of them of B3X" in found.verdict


def test_noise_understated_by_a_fifth_is_refused_by_chi_square() -> None:
    # χ²/dof is 1/0.8² = 1.56, and an outlier is not what every phasor is.
    phasor = noisy(CLEAN, seed=0)
    found = identify(with_noise(relative=0.008), Measurement.of(speed=SPEED, phasor=phasor), Options(starts=1))
    assert not found.accepted
    assert found.chi_square / found.degrees_of_freedom == pytest.approx(1.56, rel=0.06)
    assert sum(found.outliers.values()) <= 0.01 * phasor.size


def test_clean_data_have_hardly_an_outlier() -> None:
    # exp(-size²) is the chance of a larger circular Gaussian error: the limit holds it at a hundredth per run.
    assert math.exp(-outlier_limit(np.ones((100, 8), dtype=bool))) * 800 == pytest.approx(0.01)
    counts = [
        sum(identify(chapter_3(), Measurement.of(speed=SPEED, phasor=noisy(CLEAN, seed=seed))).outliers.values())
        for seed in range(10)
    ]
    assert sum(counts) <= 1


def test_one_disc_noise_is_found_from_few_channels() -> None:
    document = one_disc_document()
    document["noise"] = {"relative": 0.05, "floor": 0.0, "estimated": True}
    document["parameters"] = [{"names": "bearing.B2.*", "tied_to": "bearing.B1"}]
    machine = parse_machine(document)
    speed = np.linspace(20.0, 400.0, 300)
    found = identify(machine, Measurement.of(speed=speed, phasor=noisy(full_response(machine, speed), seed=2, relative=0.01)))
    assert found.accepted, found.verdict
    assert found.noise.relative == pytest.approx(0.01, rel=0.1)


def test_a_pattern_too_small_for_chi_square_is_remarked() -> None:
    document = chapter_3_document()
    document["couplings"][0]["kxx"] *= 1.5
    document["parameters"] = [{"names": "coupling.C1.kxx", "fixed": True}]
    speed = np.arange(2.0, 300.0, 2.0)
    phasor = noisy(dense_response(chapter_3(), speed, direction=1), seed=0)
    wrong = identify(parse_machine(document), Measurement.of(speed=speed, phasor=phasor))
    right = identify(chapter_3(), Measurement.of(speed=speed, phasor=phasor))
    assert right.accepted
    assert "alike" not in right.verdict
    assert wrong.accepted
    assert "residuals of neighbouring speeds are alike" in wrong.verdict


def coverage(found: Identification) -> float:
    """Part of the coefficients' 95 % intervals that hold the truth."""
    true = true_values(chapter_3())
    inside = [
        one.lower <= true[one.name].real <= one.upper
        for one in found.estimates
        if one.quantity != "unbalance" and one.lower is not None and one.upper is not None
    ]
    return float(np.mean(inside))


def correlated(shape: tuple[int, int], correlation: float, seed: int) -> Complexes:
    """Circular errors of rms 1 that are a first-order autoregression from sample to sample."""
    rng = np.random.default_rng(seed)
    fresh = np.asarray((rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / math.sqrt(2), dtype=complex)
    errors = fresh.copy()
    for i in range(1, shape[0]):
        errors[i] = correlation * errors[i - 1] + math.sqrt(1 - correlation**2) * fresh[i]
    return errors


def test_errors_alike_from_sample_to_sample_widen_the_intervals() -> None:
    """Without widening 70 % of the intervals held the truth at a correlation of 0.5."""
    speed = np.arange(2.0, 300.0, 2.0)
    clean = dense_response(chapter_3(), speed, direction=1)
    found = [
        identify(
            chapter_3(),
            Measurement.of(speed=speed, phasor=clean + 0.01 * np.abs(clean) * correlated(clean.shape, 0.5, seed)),
        )
        for seed in range(4)
    ]
    assert all("intervals are widened" in one.verdict for one in found)
    assert np.mean([coverage(one) for one in found]) > 0.88


def test_a_noisier_channel_is_weighed_as_such() -> None:
    speed = np.arange(2.0, 300.0, 2.0)
    clean = dense_response(chapter_3(), speed, direction=1)
    found = []
    for seed in range(4):
        phasor = noisy(clean, seed=seed)
        phasor[:, 2] += 0.05 * np.abs(clean[:, 2]) * correlated((speed.size, 1), 0.0, 100 + seed)[:, 0]
        found.append(identify(with_noise(estimated=True), Measurement.of(speed=speed, phasor=phasor)))
    assert all(one.accepted and "at B2X" in one.verdict for one in found)
    assert all(sum(one.outliers.values()) < 5 for one in found)
    assert np.mean([coverage(one) for one in found]) > 0.88


def test_a_gain_error_is_no_noise() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[:, 4] *= 1.1
    found = identify(with_noise(estimated=True), Measurement.of(speed=SPEED, phasor=phasor), Options(starts=1))
    assert not found.accepted
    assert "B3X" in found.verdict
