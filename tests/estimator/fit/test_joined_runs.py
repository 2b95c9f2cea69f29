"""Several runs at once: trial weights, both senses of rotation, channels that are missing; against full solves."""

import math

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.phasors.measurement import Measurement, joined
from tests.estimator.full_train import deviations, full_response, true_values, unbalance_force
from tests.estimator.trains import Complexes, Floats, chapter_3, chapter_3_document, noisy, truth

SPEED: Floats = np.arange(10.0, 300.0, 3.0)
TRIAL: Complexes = np.array([0.0, 0.004j, -0.003, 0.0])
"""Trial weights at D2 and D3 [kg m]."""


def run(direction: int = 1, *, seed: int, trial: Complexes | None = None, stated: bool = True) -> Measurement:
    residual = truth(chapter_3())[1]
    force = unbalance_force(chapter_3(), residual if trial is None else residual + trial)
    phasor = noisy(full_response(chapter_3(), SPEED, direction=direction, force=force), seed=seed)
    measurement = Measurement.of(speed=SPEED, phasor=phasor, direction=direction)
    return measurement if trial is None or not stated else measurement.with_trial_weight(trial)


def assert_true(found: Identification) -> None:
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) < 5 * math.sqrt(2 / found.degrees_of_freedom)
    assert np.abs(deviations(found, true_values(chapter_3()))).max() < 4.0


@pytest.mark.parametrize("direction", [1, -1])
def test_trial_weights_of_one_run_are_no_residual_unbalance(direction: int) -> None:
    assert_true(identify(chapter_3(), joined([run(direction, seed=1), run(direction, seed=2, trial=TRIAL)])))


def test_trial_weights_that_are_not_stated_are_refused() -> None:
    runs = [run(seed=1), run(seed=2, trial=TRIAL, stated=False)]
    assert not identify(chapter_3(), joined(runs), Options(starts=1)).accepted


def test_trial_weights_for_another_number_of_discs_are_an_error() -> None:
    with pytest.raises(ValueError, match="given for 1 discs, machine 'thesis-chapter-3' has 4"):
        identify(chapter_3(), run(seed=1).with_trial_weight(np.array([0.001 + 0j])))


def test_joined_knows_which_samples_had_the_trial_weight() -> None:
    plain, weighted = run(seed=1), run(seed=2, trial=TRIAL)
    found = joined([plain, weighted, plain])
    assert found.added is not None
    count = SPEED.size
    assert np.array_equal(found.added[:count], np.zeros((count, 4)))
    assert np.array_equal(found.added[count : 2 * count], np.tile(TRIAL, (count, 1)))
    assert np.array_equal(found.added[2 * count :], np.zeros((count, 4)))
    picked = found.pick(found.added[:, 1] != 0)
    assert picked.added is not None
    assert np.array_equal(picked.phasor, weighted.phasor)
    assert joined([plain, plain]).added is None


def test_both_senses_with_a_trial_weight_in_one() -> None:
    found = identify(chapter_3(), joined([run(1, seed=3), run(-1, seed=4, trial=TRIAL), run(-1, seed=5)]))
    assert_true(found)
    assert found.samples == 3 * SPEED.size


def test_channel_missing_all_the_time() -> None:
    measurement = run(seed=6)
    phasor = measurement.phasor.copy()
    phasor[:, 3] = np.nan
    missing = Measurement.of(speed=SPEED, phasor=phasor)
    found = identify(chapter_3(), missing)
    assert_true(found)
    document = chapter_3_document()
    del document["probes"][3]
    other = identify(
        type(chapter_3()).model_validate(document), Measurement.of(speed=SPEED, phasor=np.delete(phasor, 3, axis=1))
    )
    assert found.degrees_of_freedom == other.degrees_of_freedom
    for one, twin in zip(found.estimates, other.estimates, strict=True):
        assert one.value == pytest.approx(twin.value, rel=1e-6, abs=1e-6 * (one.standard_error or 0.0))


def test_each_run_lacks_another_channel() -> None:
    runs = [run(1, seed=7), run(-1, seed=8)]
    usable = [one.usable.copy() for one in runs]
    usable[0][:, :2] = False
    usable[1][30:, 5] = False
    found = identify(chapter_3(), joined([replace(one, usable=u) for one, u in zip(runs, usable, strict=True)]))
    assert_true(found)
    assert found.degrees_of_freedom == 2 * sum(int(u.sum()) for u in usable) - 50
