"""Flags and findings of runs that need no model of the machine."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.rules import Noise, QualityRules
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.quality import MEANING, Flag, assess, scatter_from_neighbours
from estimator.phasors.recorded_run import RecordedRun
from estimator.units import rpm_to_rad_per_s
from tests.estimator.sweeps import Complexes, Floats, noisy, recorded, single_mass, steady
from tests.paths import ROOT

NOISE = Noise(relative=0.01, floor=1e-9)
CHANNELS = ("X", "Y")
SAMPLES = 120


def run(seed: int = 1) -> RecordedRun:
    """A slow run-down through a well damped resonance, without anything wrong."""
    speed = np.linspace(300.0, 60.0, SAMPLES)
    clean = steady(single_mass(natural_frequency=150.0, damping_ratio=0.1), speed)
    return recorded(np.linspace(0.0, 6000.0, SAMPLES), speed, noisy(clean, seed), CHANNELS)[0]


def flagged(one: RecordedRun, flag: Flag, rules: QualityRules | None = None) -> list[list[int]]:
    """Samples with a flag, per channel."""
    flags = assess(one, noise=NOISE, rules=rules).flags
    return [np.flatnonzero(column & np.uint16(flag)).tolist() for column in flags.T]


def changed(one: RecordedRun, samples: slice, channel: int, value: Complexes | complex) -> RecordedRun:
    phasor = one.phasor.copy()
    phasor[samples, channel] = value
    return replace(one, phasor=phasor)


def test_every_flag_has_its_own_bit_name_and_meaning() -> None:
    assert set(MEANING) == set(Flag)
    assert len({one.label for one in Flag}) == len(Flag)
    assert Flag.SWEEP_RATE_BEAT.label == "sweep-rate-beat"
    assert max(Flag) < 2**16
    page = (ROOT / "docs" / "method-run-downs.md").read_text()
    assert [one.label for one in Flag if f"`{one.label}`" not in page] == []


@pytest.mark.parametrize("seed", range(8))
def test_nothing_is_found_where_nothing_is_wrong(seed: int) -> None:
    quality = assess(run(seed), noise=NOISE)
    assert quality.counts == {}
    assert quality.findings == ()
    assert quality.words == ""
    assert quality.usable.all()


def test_what_the_source_says_is_flagged_with_its_status() -> None:
    one = run()
    status = one.status.copy()
    status[3, 0], status[4, 0], status[5, 1] = ChannelStatus.NOT_AVAILABLE, ChannelStatus.BAD, ChannelStatus.OUT_OF_RANGE
    marked = replace(one, status=status)
    assert flagged(marked, Flag.NOT_AVAILABLE) == [[3], []]
    assert flagged(marked, Flag.BAD) == [[4], []]
    assert flagged(marked, Flag.OUT_OF_RANGE) == [[], [5]]
    assert assess(marked, noise=NOISE).words.startswith("3 of 240 phasors left out")


def test_a_rail_and_a_frozen_value_are_seen() -> None:
    one = run()
    limit = 0.6 * np.abs(one.phasor[:, 0]).max()
    clipped = one.phasor[:, 0] * np.minimum(1.0, limit / np.abs(one.phasor[:, 0]))
    at_rail = np.flatnonzero(np.abs(one.phasor[:, 0]) > limit).tolist()
    longest = max(np.split(at_rail, np.flatnonzero(np.diff(at_rail) > 1) + 1), key=len)
    assert len(longest) >= 5
    assert set(longest) <= set(flagged(changed(one, slice(None), 0, clipped), Flag.SATURATED)[0]) <= set(at_rail)
    assert flagged(changed(one, slice(100, 110), 1, one.phasor[100, 1]), Flag.FROZEN) == [[], list(range(100, 110))]


def test_an_outlier_is_flagged_in_its_channel() -> None:
    one = run()
    assert flagged(changed(one, slice(40, 41), 1, 1.5 * one.phasor[40, 1]), Flag.OUTLIER) == [[], [40]]


def test_what_jumps_in_all_channels_at_once_may_be_a_resonance() -> None:
    one = run()
    phasor = one.phasor.copy()
    phasor[40] *= 1.5
    assert flagged(replace(one, phasor=phasor), Flag.OUTLIER) == [[], []]


def test_only_accepted_speeds_count() -> None:
    one = run()
    rules = QualityRules(accepted_rpm=(1000.0, 2000.0))
    outside = np.flatnonzero((one.speed < rpm_to_rad_per_s(1000.0)) | (one.speed > rpm_to_rad_per_s(2000.0))).tolist()
    assert flagged(one, Flag.NOT_ACCEPTED, rules) == [outside, outside]


def test_half_power_is_left_out_where_that_is_asked_for() -> None:
    one = run()
    assert flagged(one, Flag.HALF_POWER) == [[], []]
    found = flagged(one, Flag.HALF_POWER, QualityRules(half_power=True))[0]
    inside = one.speed[found]
    # Of a damping ratio of 10 % the half-power points lie 10 % on either side, nearly.
    assert inside.min() == pytest.approx(150.0 * 0.91, rel=0.03)
    assert inside.max() == pytest.approx(150.0 * 1.12, rel=0.03)


def test_a_channel_lost_for_a_while_is_named_with_its_speeds() -> None:
    one = run()
    status = one.status.copy()
    status[30:60, 0] = ChannelStatus.BAD
    (words,) = assess(replace(one, status=status), noise=NOISE).findings
    low, high = one.speed[59] / rpm_to_rad_per_s(1.0), one.speed[30] / rpm_to_rad_per_s(1.0)
    assert words == f"channel lost: X has no usable value from {high:.0f} to {low:.0f} r/min (bad)"
    status[:, 1] = ChannelStatus.NOT_AVAILABLE
    findings = assess(replace(one, status=status), noise=NOISE).findings
    assert "channel lost: Y has no usable value in the whole run (not-available)" in findings


def test_noise_is_reported_per_channel_and_compared_with_what_is_stated() -> None:
    one = run()
    loud = changed(one, slice(None), 1, noisy(one.phasor[:, 1], 5, 0.05))
    quality = assess(loud, noise=NOISE)
    assert quality.noise["X"].seen == pytest.approx(quality.noise["X"].stated, rel=0.3)
    assert quality.noise["Y"].seen == pytest.approx(5.1 * quality.noise["Y"].stated, rel=0.3)
    assert any(words.startswith("noise: Y scatters") for words in quality.findings)
    scatter = scatter_from_neighbours(loud, quality)
    expected: Floats = 0.051 * np.abs(one.phasor[:, 1])
    assert np.median(scatter[:, 1] / expected) == pytest.approx(1.0, rel=0.3)


def test_a_source_s_own_scatter_is_kept() -> None:
    one = replace(run(), scatter=np.full((SAMPLES, 2), 3e-6))
    np.testing.assert_array_equal(scatter_from_neighbours(one, assess(one, noise=NOISE)), one.scatter)
