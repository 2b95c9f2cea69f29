"""Quality of a run: for each phasor the reasons not to use it, for the run the findings a person should know.

Flags say why; the measurement keeps what was measured. Findings that need no model of the machine are made here; the effect of
the sweep's speed on the phasors needs one and is added by `estimator.identification.quality_gate`.
"""

from enum import IntFlag

import numpy as np
from msgspec import Struct, field
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.rules import Noise, QualityRules
from estimator.phasors.beating import Beat, find_beats
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.half_power import HalfPowerNotReached, half_power_points, outside, peak_samples
from estimator.phasors.local_noise import LocalFit, is_resolved, isolated_samples, local_fit, neighbour_noise
from estimator.phasors.noise import error_size
from estimator.phasors.recorded_run import RecordedRun
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s


class Flag(IntFlag):
    """Reasons not to use a phasor, as bits; stored as these numbers, written in lower case with hyphens."""

    NOT_AVAILABLE = 1
    BAD = 2
    OUT_OF_RANGE = 4
    SATURATED = 8
    FROZEN = 16
    OUTLIER = 32
    SWEEP_RATE = 64
    SWEEP_RATE_BEAT = 128
    HALF_POWER = 256
    NOT_ACCEPTED = 512
    CORRECTED = 1024

    @property
    def label(self) -> str:
        """Return the name used in answers."""
        return (self.name or "").lower().replace("_", "-")


MEANING: dict[Flag, str] = {
    Flag.NOT_AVAILABLE: "the source had no value",
    Flag.BAD: "the source calls the value bad",
    Flag.OUT_OF_RANGE: "the source calls the value out of range",
    Flag.SATURATED: "the amplitude stays at its largest value, sample after sample",
    Flag.FROZEN: "the same phasor again and again",
    Flag.OUTLIER: "no neighbouring speed agrees",
    Flag.SWEEP_RATE: "the model predicts that the sweep was too fast for the steady state",
    Flag.SWEEP_RATE_BEAT: "the 1× beats behind a resonance: the sweep rate was too high for the steady state",
    Flag.HALF_POWER: "between the half-power points of a resonance",
    Flag.NOT_ACCEPTED: "outside the speeds that are accepted",
    Flag.CORRECTED: "used, without what the model predicts that the sweep rate added",
}
"""Meaning of each flag; the only one with which a phasor is used is CORRECTED."""
EXCLUDING = ~Flag.CORRECTED
"""Flags with which a phasor is not used."""
STATUS_FLAG = {
    ChannelStatus.NOT_AVAILABLE: Flag.NOT_AVAILABLE,
    ChannelStatus.BAD: Flag.BAD,
    ChannelStatus.OUT_OF_RANGE: Flag.OUT_OF_RANGE,
}
"""Flag of each status that is not good."""

SAME_IN_A_ROW = 5
"""Number of equal amplitudes at the top, or equal phasors anywhere, in a row that are no measurement."""
SAME_VALUE = 1e-9
"""Relative difference up to which two values are equal [-]."""
RINGING_LIMIT = 1.0
"""Ringing over the noise from which on it is flagged [-]."""
SEVERAL_CHANNELS = 0.25
"""Part of the other channels that must be disturbed at once for a resonance narrower than the samples to explain it [-]."""
DISTURBED = 3.0
"""Difference of a channel from its neighbours, over its noise, from which on it is disturbed [-]."""
LOST_PART = 0.1
"""Least part of a run in one piece without usable values in which a channel counts as lost [-]."""
LOST_SAMPLES = 5
"""Least number of samples in one piece without usable values in which a channel counts as lost."""
OTHER_NOISE = 2.0
"""Factor from which on a channel's noise above the stated one is mentioned [-]."""
FEWEST_USABLE = 20
"""Least number of samples with a usable phasor; fewer are reported as too few."""


class ChannelNoiseEstimate(Struct, frozen=True):
    """Noise of a channel as its neighbouring speeds show it; NaN where unknown.

    Attributes:
        relative: Relative part [-].
        floor: Floor [m].
        stated: Median rms that the source or the document states [m].
        seen: Median rms by relative part and floor, at the same amplitudes [m].
        resolved: Whether the samples are dense enough for these to be noise; otherwise they are bounds from above.
    """

    relative: float
    floor: float
    stated: float
    seen: float
    resolved: bool


class Quality(Struct, frozen=True, eq=False):
    """Quality of a run of S samples and m channels.

    Attributes:
        channels: Ids of the channels.
        flags: Flag of each phasor (S, m), as bits.
        findings: Findings on the run, in words.
        noise: Noise by channel.
        beats: Beat behind a resonance in each channel, or None.
    """

    channels: tuple[str, ...]
    flags: NDArray[np.uint16]
    findings: tuple[str, ...]
    noise: dict[str, ChannelNoiseEstimate]
    beats: tuple[Beat | None, ...] = field(default=())
    clock_doubted: bool = False
    """True where a beat shows a quite different sweep rate than the samples' times do."""

    @property
    def usable(self) -> NDArray[np.bool_]:
        """Return which phasors may be used (S, m)."""
        return np.asarray((self.flags & np.uint16(EXCLUDING & 0xFFFF)) == 0)

    @property
    def counts(self) -> dict[str, int]:
        """Return the number of phasors by reason, of those reasons that occur."""
        number = {one.label: int(np.count_nonzero(self.flags & np.uint16(one))) for one in Flag}
        return {label: count for label, count in number.items() if count}

    @property
    def words(self) -> str:
        """Describe in one line what was left out; empty where nothing was."""
        left_out = int(np.count_nonzero(~self.usable))
        if not left_out:
            return ""
        reasons = ", ".join(f"{count} {label}" for label, count in self.counts.items() if label != Flag.CORRECTED.label)
        return f"{left_out} of {self.flags.size} phasors left out for their quality ({reasons})"

    def with_flag(self, flag: Flag, where: NDArray[np.bool_], *findings: str) -> "Quality":
        """Return the quality with one more flag on some phasors and more findings.

        Args:
            flag: The flag.
            where: True for the phasors that get it (S, m).
            findings: Findings to add.

        Returns:
            The new quality.
        """
        flags = self.flags | np.where(where, np.uint16(flag), np.uint16(0))
        return replace(self, flags=flags.astype(np.uint16), findings=(*self.findings, *findings))


def assess(run: RecordedRun, *, noise: Noise, rules: QualityRules | None = None) -> Quality:
    """Assess the quality of a run without a model of the machine.

    Args:
        run: The run.
        noise: Noise model as the document states it.
        rules: Rules of quality; None for the usual ones.

    Returns:
        The quality.
    """
    rules = rules or QualityRules()
    shape = run.phasor.shape
    flags = np.zeros(shape, np.uint16)
    for status, flag in STATUS_FLAG.items():
        flags[run.status == status] |= np.uint16(flag)
    flags[(run.status == ChannelStatus.GOOD) & ~np.isfinite(run.phasor)] |= np.uint16(Flag.NOT_AVAILABLE)
    good = flags == 0
    flags[_frozen(run.phasor, good)] |= np.uint16(Flag.FROZEN)
    flags[_saturated(run.phasor, flags == 0)] |= np.uint16(Flag.SATURATED)

    amplitude = np.where(flags == 0, np.abs(run.phasor), 0.0)
    seen, fits = {}, []
    stated = error_size(noise, amplitude, run.scatter)
    for c, channel in enumerate(run.channels):
        fit = local_fit(run.speed, run.phasor[:, c], flags[:, c] == 0)
        relative, floor = neighbour_noise(fit, amplitude[:, c])
        fits.append(fit)
        own = np.sqrt((relative * amplitude[:, c]) ** 2 + floor**2)
        used = flags[:, c] == 0
        typical, local = (float(np.median(size[used])) if used.any() else float("nan") for size in (stated[:, c], own))
        seen[channel] = ChannelNoiseEstimate(relative, floor, typical, local, is_resolved(fit, run.speed, run.phasor[:, c]))
    flags[_outliers(run, fits, stated, seen, flags == 0)] |= np.uint16(Flag.OUTLIER)
    flags[_not_accepted(run.speed, rules)] |= np.uint16(Flag.NOT_ACCEPTED)
    if rules.half_power:
        flags[_within_half_power(run, flags == 0)] |= np.uint16(Flag.HALF_POWER)
    quality = Quality(run.channels, flags, (), seen)
    if rules.sweep_rate and run.speed.size:
        quality = _ringing(run, quality, error_size(noise, amplitude, run.scatter))
    return replace(quality, findings=(*quality.findings, *_lost_channels(run, quality), *_noise_findings(quality)))


def scatter_from_neighbours(run: RecordedRun, quality: Quality) -> Floats:
    """Compute the scatter of a run whose source and document state none: each channel's noise as its neighbours show it.

    Args:
        run: The run, of S samples and m channels.
        quality: Its quality.

    Returns:
        Rms error (S, m) [m]; NaN where unknown.
    """
    scatter = run.scatter.copy()
    for c, channel in enumerate(run.channels):
        found = quality.noise[channel]
        if np.isfinite(found.relative):
            amplitude = np.abs(_smoothed(np.where(quality.usable[:, c], run.phasor[:, c], 0.0)))
            modelled = np.sqrt((found.relative * amplitude) ** 2 + found.floor**2)
            scatter[:, c] = np.where(run.scatter[:, c] > 0.0, run.scatter[:, c], np.where(modelled > 0, modelled, np.nan))
    return scatter


def too_few(quality: Quality) -> tuple[str, ...]:
    """Report a run that has hardly a usable point left.

    Args:
        quality: Quality of the run.

    Returns:
        The finding in words, or nothing.
    """
    left = int(np.count_nonzero(quality.usable.any(axis=1)))
    return (f"too few usable points: {left} samples, {FEWEST_USABLE} are needed",) if left < FEWEST_USABLE else ()


def _smoothed(values: Complexes) -> Complexes:
    """Smooth phasors over three samples: weights from an amplitude's own error would favour amplitudes that are too small."""
    padded = np.pad(values, 1, mode="edge")
    return np.asarray((padded[:-2] + 2 * padded[1:-1] + padded[2:]) / 4)


def _runs_of(same: NDArray[np.bool_], length: int) -> NDArray[np.bool_]:
    """Mark the samples (n,) in a row of `length` at least in which each is the same as the one before; same: (n - 1,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], same, [False]]).astype(np.int8)))
    found = np.zeros(same.size + 1, dtype=bool)
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        if end - begin + 1 >= length:
            found[begin : end + 1] = True
    return found


def _frozen(phasor: Complexes, good: NDArray[np.bool_]) -> NDArray[np.bool_]:
    found = np.zeros(phasor.shape, dtype=bool)
    for c in range(phasor.shape[1]):
        place = np.flatnonzero(good[:, c])
        value = phasor[place, c]
        if place.size >= SAME_IN_A_ROW:
            same = np.abs(np.diff(value)) <= SAME_VALUE * np.abs(value[1:])
            found[place[_runs_of(same, SAME_IN_A_ROW)], c] = True
    return found


def _saturated(phasor: Complexes, good: NDArray[np.bool_]) -> NDArray[np.bool_]:
    found = np.zeros(phasor.shape, dtype=bool)
    for c in range(phasor.shape[1]):
        place = np.flatnonzero(good[:, c])
        amplitude = np.abs(phasor[place, c])
        if place.size >= SAME_IN_A_ROW:
            top = amplitude >= (1.0 - 1e3 * SAME_VALUE) * amplitude.max()
            found[place[_runs_of(top[1:] & top[:-1], SAME_IN_A_ROW)], c] = True
    return found


def _outliers(
    run: RecordedRun, fits: list[LocalFit], stated: Floats, seen: dict[str, ChannelNoiseEstimate], good: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Mark phasors out of line with their neighbours, unless other channels are disturbed at the same speed."""
    found, disturbed = np.zeros(good.shape, dtype=bool), np.zeros(good.shape, dtype=bool)
    for c, channel in enumerate(run.channels):
        own = seen[channel]
        if np.isfinite(own.relative):
            modelled = np.sqrt((own.relative * np.abs(run.phasor[:, c])) ** 2 + own.floor**2)
            size = np.maximum(stated[:, c], np.where(np.isfinite(modelled), modelled, 0.0))
            found[isolated_samples(fits[c], size), c] = True
            place = fits[c].place
            disturbed[place, c] = fits[c].error > DISTURBED * size[place]
    others = np.maximum(1, good.sum(axis=1) - 1)
    several = (disturbed.sum(axis=1)[:, None] - disturbed) > SEVERAL_CHANNELS * others[:, None]
    return np.asarray(found & ~several)


def _not_accepted(speed: Floats, rules: QualityRules) -> NDArray[np.bool_]:
    if rules.accepted_rpm is None:
        return np.zeros(speed.size, dtype=bool)
    low, high = (rpm_to_rad_per_s(rpm) for rpm in rules.accepted_rpm)
    return np.asarray((speed < low) | (speed > high))


def _within_half_power(run: RecordedRun, good: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Mark the phasors between the half-power points of each channel's peaks, as far as the curve shows both."""
    found = np.zeros(good.shape, dtype=bool)
    for c in range(good.shape[1]):
        place = np.flatnonzero(good[:, c])
        place = place[np.argsort(run.speed[place], kind="stable")]
        place = place[np.concatenate([[True], np.diff(run.speed[place]) > 0.0])] if place.size else place
        if place.size < 5:
            continue
        speed, amplitude = run.speed[place], np.maximum(np.abs(_smoothed(run.phasor[place, c])), 1e-300)
        resonances = []
        for peak in peak_samples(amplitude):
            try:
                resonances.append(half_power_points(speed, amplitude, excitation="unbalance", near=float(speed[peak])))
            except (HalfPowerNotReached, ValueError):
                continue  # a bump that does not fall to half its power is no resonance of its own
        found[place[~outside(speed, resonances)], c] = True
    return found


def _ringing(run: RecordedRun, quality: Quality, size: Floats) -> Quality:
    """Return the quality with the points flagged at which a beat is seen."""
    beats = find_beats(run.speed, np.where(quality.usable, run.phasor, 0.0), quality.usable)
    where = np.zeros(run.phasor.shape, dtype=bool)
    words, doubted = [], False
    for c, beat in enumerate(beats):
        if beat is None:
            continue
        own = quality.noise[run.channels[c]]
        limit = max(float(np.median(size[:, c])), 0.0 if not np.isfinite(own.floor) else own.floor)
        where[:, c] = beat.deviation > RINGING_LIMIT * limit
        clock = _clock(run, beat)
        doubted |= bool(clock)
        words.append(
            f"sweep rate: {run.channels[c]} beats behind {rad_per_s_to_rpm(beat.natural_frequency):.0f} r/min, "
            f"{beat.turns:.1f} turns seen: the rotor rings after a resonance crossed at "
            f"{abs(rad_per_s_to_rpm(beat.acceleration)):.3g} r/min per s by the beat itself{clock}"
        )
    return replace(quality.with_flag(Flag.SWEEP_RATE_BEAT, where, *words), beats=beats, clock_doubted=doubted)


def _clock(run: RecordedRun, beat: Beat) -> str:
    """Describe the sweep rate by the times, where it is not that of the beat."""
    if run.time is None or run.time[-1] <= run.time[0]:
        return ""
    near = (
        np.abs(run.speed - beat.natural_frequency)
        <= np.sort(np.abs(run.speed - beat.natural_frequency))[min(run.speed.size - 1, FEWEST_USABLE)]
    )
    rate = abs(float(np.polyfit(run.time[near] - run.time[0], run.speed[near], 1)[0]))
    if 1.0 / 3.0 < rate / abs(beat.acceleration) < 3.0:
        return ""
    return f"; the samples' times say {rad_per_s_to_rpm(rate):.3g} r/min per s and are not to be trusted"


def _lost_channels(run: RecordedRun, quality: Quality) -> tuple[str, ...]:
    """Report channels that gave nothing, or nothing for a part of the run."""
    source = Flag.NOT_AVAILABLE | Flag.BAD | Flag.OUT_OF_RANGE | Flag.SATURATED | Flag.FROZEN
    words = []
    for c, channel in enumerate(run.channels):
        lost = (quality.flags[:, c] & np.uint16(source)) != 0
        if lost.all():
            words.append(
                f"channel lost: {channel} has no usable value in the whole run ({_exclusion_reasons(quality.flags[:, c])})"
            )
            continue
        pieces = _runs_of(lost[1:] & lost[:-1], max(LOST_SAMPLES, int(LOST_PART * lost.size)))
        if pieces.any():
            first, last = run.speed[pieces][[0, -1]]
            words.append(
                f"channel lost: {channel} has no usable value from {rad_per_s_to_rpm(first):.0f} to "
                f"{rad_per_s_to_rpm(last):.0f} r/min ({_exclusion_reasons(quality.flags[pieces, c])})"
            )
    return tuple(words)


def _exclusion_reasons(flags: NDArray[np.uint16]) -> str:
    return ", ".join(one.label for one in Flag if np.any(flags & np.uint16(one)) and one & EXCLUDING)


def _noise_findings(quality: Quality) -> tuple[str, ...]:
    """Report channels whose noise is clearly not the stated one."""
    words = []
    for channel, noise in quality.noise.items():
        if noise.resolved and noise.stated > 0.0 and noise.seen > OTHER_NOISE * noise.stated:
            words.append(f"noise: {channel} scatters {noise.seen / noise.stated:.1f} times as much as stated")
    return tuple(words)
