"""Beating behind a resonance that was crossed quickly, found in the 1× vector alone: no model and no clock are needed.

The speed changes at a steady rate α, and the rotor still rings at its natural frequency ω_n. Seen from the turning shaft this
adds to the phasor

    a e^{-ζ ω_n t} e^{-j∫(ω - ω_n) dt} = a e^{-d x} e^{∓j b x²},  x = |ω - ω_n|, b = 1/(2|α|), d = ζ ω_n / |α|

a pure sinusoid over x². It turns against the phase's lead in a run-up and with it in a run-down, ever faster. No steady state
does that: there each mode makes one loop. The sinusoid is searched behind each peak, over a background that falls off as a
mode's response does.
"""

import numpy as np
import scipy
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.phasors.half_power import peak_samples
from estimator.phasors.modal_transient import modal_deviation
from estimator.phasors.speed_law import SpeedLaw

FEWEST_TURNS = 3.0
"""Least turns of the beat behind the peak: fewer may be another resonance."""
FEWEST_SAMPLES = 16
"""Least samples behind a peak."""
SAMPLES_PER_TURN = 3.0
"""Least samples in a turn of the beat; a faster beat is not believed."""
BEHIND = 0.5
"""Part of the peak's amplitude at whose passing the window behind it begins, and ends [-]."""
LARGEST_WINDOW = 200
"""Most samples in a window."""
PEAKS = 3
"""Most peaks whose window is searched, the largest first."""
EXPLAINED = 0.6
"""Least part of what the background leaves that the beat must explain [-]."""
LIKELIHOOD_RATIO = 30.0
"""Least (n - 9) times explained over unexplained squares [-]."""
NATURAL_FREQUENCIES = 8
"""Number of trial values of ω_n before each peak."""
LAG = 4.0
"""Farthest trial value of ω_n before a peak, in units of √α."""
PROMISING = 0.4
"""Least part of what the background leaves that a first look must explain [-]."""
GRID = 512
"""Points over x² of a first look."""
DECAYS = (0.5, 2.5, 8.0)
"""Trial decays: exponents at the end of the window [-]."""
BACKGROUND = 5
"""Number of complex unknowns of the background."""


class Beat(Struct, frozen=True, eq=False):
    """A ringing mode.

    Attributes:
        natural_frequency: Natural frequency ω_n [rad/s].
        damping_ratio: Damping ratio ζ [-].
        acceleration: Rate of the speed [rad/s²], signed.
        deviation: Size (S,) of the mode's addition to the phasors [m], predicted from these three and scaled to the observed
            beat.
        turns: Turns of the beat that were seen [-].
        explained: Part of what the background leaves that the beat explains [-].
    """

    natural_frequency: float
    damping_ratio: float
    acceleration: float
    deviation: Floats
    turns: float
    explained: float


def find_beats(speed: Floats, phasor: Complexes, usable: NDArray[np.bool_]) -> tuple[Beat | None, ...]:
    """Find the clearest beat in each channel of a sweep.

    Source: own derivation: a pure sinusoid over the square of the distance from the natural frequency, in the module's
    docstring.

    Args:
        speed: Speeds (S,) in order of time [rad/s].
        phasor: Phasors (S, m) [m].
        usable: True where a phasor may be used (S, m).

    Returns:
        For each of the m channels its clearest beat, or None.
    """
    sense = 1.0 if speed[-1] >= speed[0] else -1.0
    order = _monotone(sense * speed)
    found: list[Beat | None] = []
    for channel in range(phasor.shape[1]):
        kept = order[usable[order, channel]]
        beat = _clearest(sense * speed[kept], phasor[kept, channel], sense) if kept.size > FEWEST_SAMPLES else None
        found.append(None if beat is None else _placed(beat, speed, sense))
    return tuple(found)


class _Chirp(Struct, frozen=True):
    """A fitted beat over x: ω_n (times the sense), b, d, its size a [m], the window's first place, and how good it is."""

    natural_frequency: float
    rate: float
    decay: float
    size: float
    turns: float
    explained: float
    ratio: float


def _monotone(place: Floats) -> NDArray[np.intp]:
    """Find the samples at which the speed is beyond all before: a sweep without its reversals."""
    highest = np.maximum.accumulate(place)
    return np.flatnonzero(np.concatenate([[True], place[1:] > highest[:-1]]))


def _clearest(place: Floats, phasor: Complexes, sense: float) -> _Chirp | None:
    amplitude = np.abs(phasor)
    smooth = np.convolve(np.pad(amplitude, 1, mode="edge"), [0.25, 0.5, 0.25], mode="valid")
    peaks = peak_samples(smooth)
    best: _Chirp | None = None
    for peak in peaks[np.argsort(-smooth[peaks])][:PEAKS]:
        found = _beat_behind_peak(place, phasor, smooth, int(peak), sense)
        if found is not None and (best is None or found.ratio > best.ratio):
            best = found
    return best


def _beat_behind_peak(place: Floats, phasor: Complexes, smooth: Floats, peak: int, sense: float) -> _Chirp | None:
    """Find the beat behind one peak, if there is one."""
    below = np.flatnonzero(smooth[peak:] < BEHIND * smooth[peak])
    if not below.size:
        return None
    begin = peak + int(below[0])
    above = np.flatnonzero(smooth[begin:] > BEHIND * smooth[peak])
    end = min(begin + LARGEST_WINDOW, begin + int(above[0]) if above.size else place.size)
    if end - begin < FEWEST_SAMPLES:
        return None
    where, values = place[begin:end], phasor[begin:end]
    if sense > 0:
        values = np.conj(values)  # so that the beat turns forward in both
    spacing = float(np.median(np.diff(where)))
    length = float(where[-1] - place[peak])
    # Enough turns in the window, and enough samples in the turns that are looked at.
    slowest = 2.0 * np.pi * FEWEST_TURNS / length**2
    fastest = 2.0 * np.pi / (SAMPLES_PER_TURN * spacing) / (2.0 * np.sqrt(length * (where[0] - place[peak] + spacing)))
    if fastest <= slowest:
        return None
    # The lag behind ω_n goes with √α; that of a middle rate is near enough to begin with.
    lag = np.sqrt(0.5 / np.sqrt(slowest * fastest))
    frequencies = place[peak] - lag * np.linspace(0.0, LAG, NATURAL_FREQUENCIES)
    explained, chirps = _scan(where - frequencies[:, None], values, length, slowest, fastest)
    best = int(np.argmax(explained))
    if not explained[best] > PROMISING:  # nor where nothing is known
        return None
    start = (float(frequencies[best]), *chirps[best].tolist())
    return _refined(where, values, start, lowest=float(place[0]), peak_place=float(place[peak]))


def _background(x: Floats) -> Complexes:
    """Build orthonormal columns (..., n, 5) that fall off behind a resonance, at distances (..., n) from it."""
    scaled = x / x[..., -1:]
    columns = np.stack([np.ones_like(x), scaled, 1 / scaled, 1 / scaled**2, scaled**2], axis=-1)
    return np.asarray(np.linalg.qr(columns)[0], dtype=complex)


def _scan(x: Floats, values: Complexes, length: float, slowest: float, fastest: float) -> tuple[Floats, Floats]:
    """Estimate the part of the squares that the best chirp explains: a Fourier transform over the square of the distance.

    x: distances (F, n) from F natural frequencies [rad/s]; values: phasors (n,) [m]; length: of the window behind the peak
    [rad/s]; slowest, fastest: rates that are looked for [s²/rad].

    Returns:
        For each natural frequency the part explained (F,) [-], and the chirp's rate and decay (F, 2).
    """
    background = _background(x)
    across = values @ background.conj()
    rest = values - (background @ across[..., None])[..., 0]
    square = np.linspace(x[:, 0] ** 2, x[:, -1] ** 2, GRID, axis=-1)
    at = np.sqrt(square)
    even = np.stack([np.interp(*one) for one in zip(at, x, rest, strict=True)])
    decay = np.array(DECAYS)[:, None] / length
    # Samples are even in x: a sum over them is an integral over x² with this weight.
    fall = np.exp(-decay * at[:, None])
    weight = fall / at[:, None]
    spectrum = np.fft.fft(even[:, None] * weight, 2 * GRID)[..., :GRID]
    power = spectrum.real**2 + spectrum.imag**2
    power /= np.sum(weight * fall, axis=-1, keepdims=True) * np.sum(1.0 / at, axis=-1)[:, None, None]
    rates = np.pi * np.arange(GRID) / (GRID * (square[:, 1] - square[:, 0]))[:, None]
    power *= ((rates >= slowest) & (rates <= fastest))[:, None]
    whole = power.reshape(len(x), -1)
    best = np.argmax(whole, axis=1)
    which, bin_number = np.divmod(best, GRID)
    every = np.arange(len(x))
    explained = whole[every, best] / np.maximum(np.mean(np.abs(rest) ** 2, axis=1), 1e-300)
    return explained, np.stack([rates[every, bin_number], decay[which, 0]], axis=1)


def _refined(
    where: Floats, values: Complexes, start: tuple[float, float, float], *, lowest: float, peak_place: float
) -> _Chirp | None:
    """Fit the chirp nearest to the values, from a start (ω_n, b, d); None where it is not clear enough."""
    scale = np.array([np.sqrt(0.5 / start[1]), start[1], 1.0 / (where[-1] - peak_place)])
    left_over = float(np.sqrt(np.mean(np.abs(values) ** 2)))

    def fitted(theta: Floats) -> tuple[Complexes, Complexes, complex, Floats]:
        frequency, rate, decay = theta * scale
        x = np.maximum(where - frequency, 1e-3 * scale[0])
        background = _background(x)
        chirp = np.exp(1j * rate * x**2 - abs(decay) * x)
        across = chirp - background @ (background.conj().T @ chirp)
        rest = values - background @ (background.conj().T @ values)
        size = complex(np.vdot(across, rest) / max(float(np.vdot(across, across).real), 1e-300))
        return rest, rest - size * across, size, x

    def residual(theta: Floats) -> Floats:
        return np.asarray(fitted(theta)[1].view(float) / left_over)

    if lowest + scale[0] >= where[0] - 1e-2 * scale[0]:
        return None
    begin = np.array(start) / scale
    # The resonance was crossed in this sweep, not before it.
    low = np.array([max(lowest + scale[0], peak_place - 2 * LAG * scale[0]) / scale[0], 0.5, 0.0])
    high = np.array([(where[0] - 1e-3 * scale[0]) / scale[0], 2.0, 20.0])
    solved = scipy.optimize.least_squares(residual, np.clip(begin, low + 1e-9, high - 1e-9), bounds=(low, high), max_nfev=30)
    rest, unexplained, size, x = fitted(solved.x)
    frequency, rate, decay = (solved.x * scale).tolist()
    whole, left = float(np.vdot(rest, rest).real), float(np.vdot(unexplained, unexplained).real)
    if whole <= 0.0:
        return None
    explained = 1.0 - left / whole
    freedom = 2 * where.size - 2 * BACKGROUND - 5
    ratio = freedom * explained / max(1.0 - explained, 1e-12)
    # Turns that carry weight: as far as the beat stands above what is left.
    noise = np.sqrt(left / where.size)
    seen = abs(size) * np.exp(-abs(decay) * x) > noise
    turns = float(rate * (x[seen].max() ** 2 - x[0] ** 2) / (2.0 * np.pi)) if seen.any() else 0.0
    if explained < EXPLAINED or ratio < LIKELIHOOD_RATIO or turns < FEWEST_TURNS:
        return None
    return _Chirp(frequency, rate, abs(decay), abs(size), turns, explained, ratio)


def _placed(beat: _Chirp, speed: Floats, sense: float) -> Beat:
    """Add to the beat its deviation at every sample: one mode through the same sweep, scaled to the observed size."""
    frequency, acceleration = sense * beat.natural_frequency, sense / (2.0 * beat.rate)
    growth = complex(-beat.decay * abs(acceleration), frequency)
    place = np.maximum.accumulate(sense * speed)
    grid = np.linspace(place[0], place[-1], max(400, 8 * speed.size))
    law = SpeedLaw.through((grid - grid[0]) / abs(acceleration), sense * grid)
    shape = np.abs(modal_deviation(law, (grid - grid[0]) / abs(acceleration), growth))
    x = np.maximum(grid - beat.natural_frequency, 0.0)
    behind = (x > 0.0) & (2.0 * beat.rate * x**2 > np.pi)
    expected = beat.size * np.exp(-beat.decay * x)
    scale = float(np.sum(expected[behind] * shape[behind]) / max(np.sum(shape[behind] ** 2), 1e-300)) if behind.any() else 0.0
    deviation = np.interp(place, grid, scale * shape)
    return Beat(
        natural_frequency=frequency,
        damping_ratio=-growth.real / abs(growth),
        acceleration=acceleration,
        deviation=deviation,
        turns=beat.turns,
        explained=beat.explained,
    )
