"""Distance of a run from an earlier one of its kind."""

import numpy as np

from estimator.phasors.repeatability import EarlierRun, distances, repeatability_findings
from tests.estimator.sweeps import noisy, steady
from tests.estimator.trains import chapter_3

SPEED = np.linspace(560.0, 60.0, 200)
OTHER = np.linspace(555.0, 62.0, 240)


def earlier(seed: int) -> EarlierRun:
    phasor = noisy(steady(chapter_3(), OTHER), seed)
    return EarlierRun("run 7", OTHER, phasor, np.isfinite(phasor))


def found(phasor: np.ndarray[tuple[int, ...], np.dtype[np.complex128]], seed: int) -> tuple[str, ...]:
    far = distances(SPEED, phasor, 0.01 * np.abs(phasor), np.isfinite(phasor), earlier(seed))
    return repeatability_findings(chapter_3().channels, far, "run 7")


def test_a_run_that_repeats_itself_is_one_noise_away() -> None:
    phasor = noisy(steady(chapter_3(), SPEED), 1)
    far = distances(SPEED, phasor, 0.01 * np.abs(phasor), np.isfinite(phasor), earlier(2))
    assert all(one is not None and 0.7 < one.noises < 1.3 and one.points > 150 for one in far)
    assert found(phasor, 2) == ()


def test_one_channel_that_changed_is_named_alone() -> None:
    phasor = noisy(steady(chapter_3(), SPEED), 1)
    phasor[:, 3] *= 1.3
    (words,) = found(phasor, 2)
    assert "only B2Y" in words
    assert "look at the channel" in words


def test_a_machine_that_changed_is_reported_with_its_channels() -> None:
    (words,) = found(1.2 * noisy(steady(chapter_3(), SPEED), 1), 2)
    assert all(channel in words for channel in chapter_3().channels)
    assert words.endswith("differ from run 7")


def test_runs_over_other_speeds_say_nothing() -> None:
    phasor = noisy(steady(chapter_3(), SPEED), 1)
    far = distances(SPEED + 600.0, phasor, np.abs(phasor), np.isfinite(phasor), earlier(2))
    assert far == (None,) * 8
