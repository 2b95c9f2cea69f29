"""Differences between mountings beside trial weights: large ones by chance are borne, those of wrong weights are refused."""

import re

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration.simulated_trains import RUNS, SPEEDS, MountedTrain
from estimator.arrays import Complexes
from estimator.calibration.calibrate import LARGE_MOUNTING_PART, calibrate
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.weights_in_step import IN_STEP, NOT_SEEN, ONE_MORE, TOO_FEW, judge_differences

MOUNTINGS, DISCS = 8, 4


def drawn(seed: int) -> tuple[Complexes, Complexes]:
    """Return differences of unit size and weights seven times as large, on one disc after the other."""
    rng = np.random.default_rng(seed)
    parts = rng.standard_normal((2, MOUNTINGS, DISCS))
    weight = np.zeros((MOUNTINGS, DISCS), dtype=complex)
    for number in range(1, MOUNTINGS):
        weight[number, number % DISCS] = 7.0 * np.exp(2j * np.pi * rng.random())
    return parts[0] + 1j * parts[1], weight


def test_chance_is_seldom_taken_for_wrong_weights() -> None:
    doubted = [bool(judge_differences(*drawn(seed), part=0.4)) for seed in range(1000)]
    assert sum(doubted) <= 5


@pytest.mark.parametrize("seed", range(10))
def test_differences_that_go_with_weights_are_doubted(seed: int) -> None:
    difference, weight = drawn(seed)
    assert judge_differences(difference + np.conj(weight) - weight, weight, part=0.9) == IN_STEP
    opposite = weight.copy()
    opposite[1] *= -1.0
    assert judge_differences(difference + weight - opposite, opposite, part=0.6) in {IN_STEP, ONE_MORE}


def test_weights_that_do_hardly_more_than_chance_are_not_believed() -> None:
    difference, weight = drawn(0)
    assert judge_differences(difference, weight, part=0.5) == ""
    assert judge_differences(difference, weight, part=2.0) == NOT_SEEN
    assert judge_differences(difference[:1], weight[:1], part=0.4) == TOO_FEW


def few(seed: int, *, mountings: int, turned: bool = False) -> tuple[Complexes, Complexes, float]:
    """Return differences, weights and their ratio of a fit with two discs, which differ by a fifth of what weights do."""
    rng = np.random.default_rng(seed)
    weight = np.zeros((mountings, 2), dtype=complex)
    for number in range(1, mountings):
        weight[number, number % 2] = np.exp(2j * np.pi * rng.random())
    parts = 0.2 / np.sqrt(2.0) * rng.standard_normal((2, mountings, 2))
    shown = weight + parts[0] + 1j * parts[1]
    stated = weight[:, ::-1] if turned else weight
    centred = stated - stated.mean(axis=0)
    factor = np.vdot(centred, shown - shown.mean(axis=0)) / np.sum(np.abs(centred) ** 2)
    difference = (shown - shown.mean(axis=0)) / factor - centred
    size = np.sqrt(np.sum(np.abs(difference) ** 2) / (2 * (mountings - 1) - 1))
    return difference / size, stated / size, float(np.linalg.norm(difference) / np.linalg.norm(stated))


@pytest.mark.parametrize("mountings", [3, 4, 5])
def test_right_weights_of_few_mountings_are_hardly_ever_called_wrong(mountings: int) -> None:
    """With a level of 10 % for fewer than eight free differences some 5 % of those that differ much were called wrong."""
    drawn = [few(seed, mountings=mountings) for seed in range(1000)]
    told = [judge_differences(difference, weight, part=part) for difference, weight, part in drawn if part > 0.3]
    assert len(told) > 15
    assert sum(one == IN_STEP for one in told) <= 0.01 * len(told)
    if mountings > 3:  # three leave hardly anything to compare light weights with
        assert sum(one == NOT_SEEN for one in told) <= 0.05 * len(told)


@pytest.mark.parametrize("mountings", [3, 4, 5])
def test_weights_of_exchanged_discs_are_refused_with_few_mountings_too(mountings: int) -> None:
    drawn = [few(seed, mountings=mountings, turned=True) for seed in range(200)]
    told = [judge_differences(difference, weight, part=part) for difference, weight, part in drawn if part > 0.3]
    assert len(told) > 190
    assert np.mean([bool(one) for one in told]) > 0.95


@pytest.mark.parametrize("mountings", [8, 20])
def test_some_weights_in_another_unit_are_refused(mountings: int) -> None:
    """They decide the gains, beside which all other runs differ by as much as the wrong weights do."""
    told = []
    for seed in range(50):
        rng = np.random.default_rng(seed)
        weight = np.zeros((mountings, 2), dtype=complex)
        for number in range(1, mountings):
            weight[number, number % 2] = np.exp(2j * np.pi * rng.random())
        stated = np.where(np.arange(mountings)[:, None] % 3 == 1, 25.4 * weight, weight)
        parts = 0.2 / np.sqrt(2.0) * rng.standard_normal((2, mountings, 2))
        centred = stated - stated.mean(axis=0)
        shown = weight + parts[0] + 1j * parts[1]
        shown = shown - shown.mean(axis=0)
        factor = np.vdot(centred, shown) / np.sum(np.abs(centred) ** 2)
        difference = shown / factor - centred
        size = np.sqrt(np.sum(np.abs(difference) ** 2) / (2 * (mountings - 1) - 1))
        part = float(np.linalg.norm(difference) / np.linalg.norm(stated))
        told.append(part > 0.3 and bool(judge_differences(difference / size, stated / size, part=part)))
    assert np.mean(told) > 0.95


@pytest.fixture(scope="module")
def scattered() -> tuple[MountedTrain, list[CalibrationRun]]:
    """A train whose mountings happen to differ by nearly a third of what its weights do, 10 µm of eccentricity."""
    plant = MountedTrain("motor-pump", 0)
    plant.trial_weight = 1e-5 * plant.mass
    return plant, plant.runs(RUNS, SPEEDS)


def test_a_train_that_differs_much_from_mounting_to_mounting_calibrates(
    scattered: tuple[MountedTrain, list[CalibrationRun]],
) -> None:
    plant, runs = scattered
    found = calibrate(plant.machine, runs)
    assert found.accepted, found.verdict
    told = re.search(r"mountings differ by (\d+) % of what the trial weights do, by chance", found.verdict)
    assert told, found.verdict
    assert 100 * LARGE_MOUNTING_PART < int(told[1]) < 40


def test_the_same_train_with_angles_counted_the_other_way_round_is_refused(
    scattered: tuple[MountedTrain, list[CalibrationRun]],
) -> None:
    plant, runs = scattered
    turned = [
        replace(one, measurement=replace(one.measurement, added=np.conj(np.asarray(one.measurement.added)))) for one in runs
    ]
    found = calibrate(plant.machine, turned)
    assert not found.accepted
    assert IN_STEP in found.verdict


@pytest.mark.long
def test_the_same_train_with_the_weights_of_two_runs_exchanged_is_refused(
    scattered: tuple[MountedTrain, list[CalibrationRun]],
) -> None:
    plant, runs = scattered
    put = [one.measurement.added for one in runs]
    put[1], put[2] = put[2], put[1]
    swapped = [replace(one, measurement=replace(one.measurement, added=said)) for one, said in zip(runs, put, strict=True)]
    found = calibrate(plant.machine, swapped)
    assert not found.accepted
    assert "mountings differ by" in found.verdict
