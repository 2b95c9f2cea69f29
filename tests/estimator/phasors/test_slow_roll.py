"""Slow-roll vectors: captured, refused, turned for the other sense of rotation, subtracted, and their error in the fit."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.slow_roll import NotSlowRoll, SlowRoll, capture, corrected, subtracted
from tests.estimator.trains import (
    Complexes,
    Floats,
    chapter_3,
    chapter_3_document,
    dense_response,
    few_examples,
    noisy,
    one_disc_document,
)

RPM = math.pi / 30.0
CHANNELS = 8


def slow(vector: Complexes, *, noise: float = 1e-7, samples: int = 60, growth: float = 0.0, seed: int = 0) -> Measurement:
    """Phasors from 200 to 400 rpm: a vector per channel, noise of this rms [m], and what grows by this much up to 400 rpm."""
    rng = np.random.default_rng(seed)
    speed = np.linspace(200.0, 400.0, samples) * RPM
    errors = rng.standard_normal((samples, CHANNELS)) + 1j * rng.standard_normal((samples, CHANNELS))
    grown = growth * (speed / speed[-1])[:, None] ** 2
    return Measurement.of(speed=speed, phasor=vector + grown + noise / math.sqrt(2) * errors)


def drawn(seed: int = 5, size: float = 1e-5) -> Complexes:
    rng = np.random.default_rng(seed)
    return np.asarray(size * np.exp(2j * np.pi * rng.random(CHANNELS)))


@pytest.mark.parametrize("growth", [0.0, 3e-8, 1e-7, 3e-7])
def test_vectors_are_the_means_and_their_errors_are_honest(growth: float) -> None:
    # Vibration that hides in the noise of 1e-7 moves the mean by up to many times that noise over √60.
    vector = drawn()
    off = []
    for seed in range(100):
        measurement = slow(vector, growth=growth, seed=seed)
        found = capture(chapter_3(), measurement, lowest=200 * RPM, highest=400 * RPM).slow_roll
        assert found.known.all()
        assert np.allclose(found.vector, measurement.phasor.mean(axis=0))
        off.append(np.abs(found.vector - vector) / found.standard_error)
    # Too small an error misleads; what the noise leaves possible makes it too large where there is no growth.
    assert np.mean(np.square(off)) < 1.4
    assert found.standard_error.max() < 1e-7 + 2.0 * growth


def test_in_a_narrow_band_the_error_is_that_of_the_mean() -> None:
    vector = drawn()
    off = []
    for seed in range(200):
        held = slow(vector, seed=seed)
        measurement = replace(held, speed=np.full(60, 250.0 * RPM))
        found = capture(chapter_3(), measurement, lowest=200 * RPM, highest=400 * RPM).slow_roll
        off.append(np.abs(found.vector - vector) / found.standard_error)
    # The squared error over its variance has the mean 1; 1600 of them, each widened a little for neighbours alike by chance.
    assert 0.75 < np.mean(np.square(off)) < 1.1
    assert found.standard_error == pytest.approx(np.full(CHANNELS, 1e-7 / math.sqrt(60)), rel=0.4)


def test_only_the_band_and_good_phasors_count() -> None:
    vector = drawn()
    measurement = slow(vector)
    phasor, usable = measurement.phasor.copy(), measurement.usable.copy()
    phasor[measurement.speed > 300 * RPM] = 1e-3
    usable[5, 2], phasor[5, 2] = False, 1.0
    found = capture(
        chapter_3(),
        Measurement(measurement.speed, measurement.direction, phasor, usable, measurement.scatter),
        lowest=200 * RPM,
        highest=300 * RPM,
    )
    assert np.max(np.abs(found.slow_roll.vector - vector)) < 1e-7
    assert found.samples == 30
    assert found.speed_maximum <= 300 * RPM


def test_vibration_is_no_slow_roll() -> None:
    with pytest.raises(NotSlowRoll, match="this is vibration") as caught:
        capture(chapter_3(), slow(drawn(), growth=1e-5), lowest=200 * RPM, highest=400 * RPM)
    assert set(caught.value.reasons) == set(chapter_3().channels)


def test_some_growth_is_taken_into_the_error() -> None:
    vector = drawn()
    found = capture(chapter_3(), slow(vector, growth=1e-6), lowest=200 * RPM, highest=400 * RPM).slow_roll
    assert found.known.all()
    assert np.all(found.standard_error > 0.5 * np.abs(found.vector - vector))
    assert np.all(found.standard_error > 2e-7)


def test_vectors_that_scatter_are_refused_one_by_one() -> None:
    measurement = slow(drawn())
    phasor = measurement.phasor.copy()
    rng = np.random.default_rng(3)
    phasor[:, 3] = 1e-5 * np.exp(2j * np.pi * rng.random(60))
    phasor[3:, 6] = np.nan
    one = Measurement.of(speed=measurement.speed, phasor=phasor)
    found = capture(chapter_3(), one, lowest=200 * RPM, highest=400 * RPM)
    assert found.slow_roll.known.tolist() == [column not in (3, 6) for column in range(CHANNELS)]
    assert "scatter" in found.reasons["B2Y"]
    assert "3 good samples in the band" in found.reasons["B4X"]


def test_alike_neighbours_count_less() -> None:
    measurement = slow(drawn(), samples=60)
    twice = Measurement.of(speed=np.repeat(measurement.speed, 2), phasor=np.repeat(measurement.phasor, 2, axis=0))
    once = capture(chapter_3(), measurement, lowest=200 * RPM, highest=400 * RPM).slow_roll.standard_error
    both = capture(chapter_3(), twice, lowest=200 * RPM, highest=400 * RPM).slow_roll.standard_error
    assert np.median(both / once) > 0.9  # not 1/√2: nothing was measured twice


@pytest.mark.parametrize("band", [(0.0, 10.0), (20.0, 10.0), (10.0, 10.0)])
def test_a_band_that_is_none(band: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="speed band"):
        capture(chapter_3(), slow(drawn()), lowest=band[0], highest=band[1])
    with pytest.raises(NotSlowRoll, match="0 good samples"):
        capture(chapter_3(), slow(drawn()), lowest=900 * RPM, highest=1000 * RPM)


@pytest.mark.parametrize("keyphasor_deg", [0.0, 70.0])
def test_the_other_sense_of_rotation_shows_the_conjugate(keyphasor_deg: float) -> None:
    # A turning shaft with a pattern on its surface, looked at by two probes in time; phasors by Fourier's integral.
    pattern, probes, spin = 1e-5 * np.exp(0.7j), np.deg2rad([135.0, 20.0]), 20.0
    seen = {}
    for direction in (1, -1):
        # t = 0 when the mark, at angle 0 of the shaft, passes the keyphasor.
        time = np.arange(1000) * 2 * np.pi / spin / 1000
        mark = math.radians(keyphasor_deg) + direction * spin * time
        surface = np.array([np.real(pattern * np.exp(1j * (probe - mark))) for probe in probes])
        seen[direction] = 2 * np.mean(surface * np.exp(-1j * spin * time), axis=1)
    slow_roll = SlowRoll(1, seen[1], np.zeros(2))
    assert np.allclose(slow_roll.turned(np.array([1.0, -1.0])), [seen[1], seen[-1]])
    assert np.allclose(SlowRoll(-1, seen[-1], np.zeros(2)).turned(np.array([1.0, -1.0])), [seen[1], seen[-1]])


@few_examples
@given(st.integers(0, 1000), st.sampled_from([1, -1]))
def test_subtracting_is_reversible_and_leaves_the_raw_alone(seed: int, direction: int) -> None:
    both = joined(
        [slow(drawn(seed), seed=seed), Measurement.of(speed=np.ones(4), phasor=np.full((4, 8), 1e-5), direction=-1.0)]
    )
    raw = both.phasor.copy()
    vector = drawn(seed + 1)
    vector[2] = np.nan
    slow_roll = SlowRoll(direction, vector, np.zeros(8))
    found = subtracted(both, slow_roll)
    assert np.array_equal(both.phasor, raw)
    assert np.array_equal(found.phasor[:, 2], raw[:, 2])
    assert np.allclose(found.phasor + slow_roll.turned(both.direction), raw, rtol=0, atol=1e-18)
    again = subtracted(found, SlowRoll(direction, -vector, np.zeros(8)))
    assert np.allclose(again.phasor, raw, rtol=0, atol=1e-18)


def runs(run_out: Complexes, *, speed: Floats, seed: int) -> Measurement:
    clean = dense_response(chapter_3(), speed, direction=1)
    return Measurement.of(speed=speed, phasor=noisy(clean + run_out, seed=seed))


def errors(found: Identification) -> list[float]:
    """Errors of the direct stiffnesses in standard errors."""
    truth = {f"bearing.{b['id']}.{k}": b[k] for b in chapter_3_document()["bearings"] for k in ("kxx", "kyy")}
    return [
        (one.value - truth[one.name]) / one.standard_error
        for one in found.estimates
        if one.name in truth and one.value is not None and one.standard_error
    ]


def test_identification_with_a_vector_equals_that_of_clean_data_within_its_errors() -> None:
    machine = chapter_3()  # its noise is 1 % of what a probe sees, with the run-out
    speed = np.linspace(20.0, 300.0, 100)
    run_out = drawn(size=2e-3)
    measured = runs(run_out, speed=speed, seed=3)
    assert not identify(machine, measured, Options(starts=1)).accepted
    error = 1e-6
    rng = np.random.default_rng(8)
    off = error / math.sqrt(2) * (rng.standard_normal(8) + 1j * rng.standard_normal(8))
    described, without = corrected(machine, measured, SlowRoll(1, run_out + off, np.full(8, error)))
    found = identify(described, without)
    assert found.accepted, found.verdict
    assert [name for name in found.coordinates if name.endswith("run_out.real")]
    assert max(map(abs, errors(found))) < 4.0
    clean = identify(machine, runs(np.zeros(8, complex), speed=speed, seed=3))
    for name in ("bearing.B1.kxx", "bearing.B3.kyy"):
        ours, theirs = found.estimate(name).standard_error, clean.estimate(name).standard_error
        assert ours is not None
        assert theirs is not None
        assert theirs <= 1.02 * ours


@pytest.mark.parametrize("samples", [20, 500])
def test_the_error_of_a_vector_is_common_to_all_samples(samples: int) -> None:
    """As noise it would vanish with the number of samples: at one speed an unbalance stays as uncertain as the vector."""
    document = one_disc_document()
    document["noise"] = {"relative": 1e-4, "floor": 1e-9}
    document["parameters"] = [{"names": "bearing.*", "fixed": True}]
    machine = parse_machine(document)
    speed = np.full(samples, 60.0)
    clean = dense_response(machine, speed, direction=1)
    error = 1e-6
    described, without = corrected(
        machine, Measurement.of(speed=speed, phasor=clean), SlowRoll(1, np.zeros(2, complex), np.full(2, error))
    )
    found = identify(described, without).estimate("disc.D.unbalance")
    # Two probes at right angles see the same unbalance of 1 g m: their errors are averaged.
    influence = abs(clean[0, 0]) / 1e-3
    assert found.standard_error == pytest.approx(error / math.sqrt(2) / influence / math.sqrt(2), rel=0.05)


def test_a_vector_takes_the_place_of_the_documents_spread() -> None:
    document = chapter_3_document()
    for probe in document["probes"]:
        probe["run_out_spread"] = 5e-5
    machine = parse_machine(document)
    vector = drawn()
    vector[1] = np.nan
    error = np.where(np.isfinite(vector), 1e-7, np.nan)
    described, _ = corrected(machine, slow(drawn()), SlowRoll(1, vector, error))
    assert [probe.run_out_spread for probe in described.probes] == [5e-5 if i == 1 else 1e-7 for i in range(8)]
