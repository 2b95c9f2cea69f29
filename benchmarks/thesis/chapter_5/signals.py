"""Chapter 5: reading phasors from noisy signals."""

import math

import numpy as np

from benchmarks.thesis.tables import percent, table
from estimator.thesis.rig import SPEEDS_HZ
from estimator.thesis.signal_noise import decibels, noisy_signal, phasor_error
from estimator.thesis.time_history import band_passed, extrema_phasor, least_squares_phasor

READINGS = 200

RECORD = 2.0
"""Length of a record [s]; the thesis does not print it."""


def signals_section() -> str:
    """Return the section on Appendix E, and on the cost of the thesis's way of reading a phasor."""
    table_e = [
        [f"{one:g} %", printed, f"{decibels(one):.2f}"]
        for one, printed in ((1, "40.00"), (2, "33.98"), (5, "26.02"), (100, "0"))
    ]
    rng = np.random.default_rng(0)
    rows = []
    for hertz in (SPEEDS_HZ[0], SPEEDS_HZ[3], SPEEDS_HZ[-1]):
        errors = np.array([_reading_errors(hertz, rng) for _ in range(READINGS)])
        rms = np.sqrt(np.mean(np.abs(errors) ** 2, axis=0))
        rows.append([f"{hertz:.0f}", *[percent(float(one)) for one in rms], percent(phasor_error(percent=5.0, samples=2000))])
    return (
        "### Appendix E: noise in decibels, and from signal to phasor\n\n"
        + table(["noise", "printed [dB]", "here [dB]"], table_e)
        + "\n\nThe thesis reads one maximum and one minimum of the band-passed signal (±2 Hz, Eq. 5.1) and the time from the "
        f"keyphasor's pulse (Eq. 5.2), at 1 kHz sampling. Relative rms error of the phasor over {READINGS} simulated records "
        f"of {RECORD:g} s with 5 % white noise (seed 0), random phase and random instant of the pulse:\n\n"
        + table(
            [
                "[Hz]",
                "one maximum and minimum, pulse known to a sample",
                "least squares, pulse known to a sample",
                "least squares, exact pulse",
                "the last one by formula",
            ],
            rows,
        )
        + "\n\nThe noise is not the matter; time is. A millisecond is 15° at 41 Hz. What the pulse adds turns all channels "
        "of a record together, half a sample on average; what the maximum adds differs from channel to channel, and every "
        "bound above grows with it. An interpolated pulse and a least-squares fit over the whole record bring 5 % of noise "
        "down to a part of a per cent."
    )


def _reading_errors(hertz: float, rng: np.random.Generator) -> list[complex]:
    """Return the relative errors of three ways to read one record."""
    rate = 1000.0
    time = np.arange(int(RECORD * rate)) / rate
    pulse = 0.8 + rng.uniform(0.0, 1.0 / hertz)
    phase = rng.uniform(-math.pi, math.pi)
    signal = np.cos(2 * math.pi * hertz * (time - pulse) + phase)
    noisy = noisy_signal(signal, decibels=decibels(5.0), rng=rng)
    seen = math.ceil(pulse * rate) / rate
    filtered = band_passed(noisy, sampling_rate=rate, frequency=hertz)
    found = (
        extrema_phasor(filtered, time=time, pulse=seen, frequency=hertz),
        least_squares_phasor(noisy, time=time, pulse=seen, frequency=hertz),
        least_squares_phasor(noisy, time=time, pulse=pulse, frequency=hertz),
    )
    return [one * complex(math.cos(phase), -math.sin(phase)) - 1.0 for one in found]
