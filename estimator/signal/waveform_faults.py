"""Faults of a waveform from a probe that does not measure: samples that are no numbers, a flat line, a rail, clipping."""

from typing import Literal

import numpy as np

from estimator.arrays import Floats

WaveformFault = Literal["not finite", "rail", "flat line", "clipped"]

UNUSABLE: frozenset[WaveformFault] = frozenset({"not finite", "rail", "flat line"})
"""Faults that leave nothing to be read; a clipped waveform still gives a phasor, too small."""
CLIPPED_IN_A_ROW = 3
"""Number of samples in a row at the extreme value that make a flat top."""
CLIPPED_RATIO = 8.0
"""Samples at the extreme over those at the value next to it from which on a top is flat [-]; the top of a rounded sine has at
most 1 / (√2 - 1) = 2.4.
"""


def waveform_fault(
    signal: Floats, *, samples_per_turn: float, rails: tuple[float, float] | None = None
) -> WaveformFault | None:
    """Find the fault of a waveform.

    Args:
        signal: Waveform (N,) [any unit].
        samples_per_turn: Samples in a turn of the shaft [-]; a flat line is one value for a turn or longer.
        rails: Measuring range [unit of the waveform]; half of the samples at its ends or beyond is a rail, any less is
            clipping.

    Returns:
        The fault, or None.
    """
    if not np.all(np.isfinite(signal)):
        return "not finite"
    if rails is not None:
        beyond = np.count_nonzero((signal <= rails[0]) | (signal >= rails[1]))
        if 2 * beyond >= signal.size:
            return "rail"
    changes = np.flatnonzero(np.diff(signal))
    longest = int(np.max(np.diff(np.concatenate([[-1], changes, [signal.size - 1]]))))
    if longest >= min(samples_per_turn, signal.size):
        return "flat line"
    if rails is not None and beyond:
        return "clipped"
    # Without three equal samples in a row there is no flat top: the usual case is settled here.
    if longest >= CLIPPED_IN_A_ROW and (_flat_top(signal) or _flat_top(-signal)):
        return "clipped"
    return None


def _flat_top(signal: Floats) -> bool:
    top = float(np.max(signal))
    at_top = signal == top
    count = np.count_nonzero(at_top)
    in_a_row = at_top[:-2] & at_top[1:-1] & at_top[2:]
    if not np.any(in_a_row):
        return False
    below = float(np.max(signal[~at_top]))
    return bool(count > CLIPPED_RATIO * np.count_nonzero(signal == below))
