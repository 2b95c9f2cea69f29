"""Text of a calibration for a terminal or a notebook."""

import math

import numpy as np

from estimator.calibration.calibrate import Calibrated
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.calibration import Calibration
from estimator.machine.parameter_description import describe

GRAM_MILLIMETRES = 1e6
"""g mm per kg m."""
MICROMETRES = 1e6
"""µm per m."""
MOST_DECIMALS = 4
"""Most decimals of what has an uncertainty of its own."""


def calibration_text(found: Calibrated) -> str:
    """Return verdict and remarks, the measuring chains, the machine's own unbalance, and what scatters."""
    calibration = found.machine.calibration
    if calibration is None:
        return found.verdict
    lines = [found.verdict if found.accepted else f"NOT ACCEPTED, not to be used: {found.verdict}", *found.remarks]
    starts = f"best of {found.starts} starts" + (", reached twice" if found.unique else "")
    mountings = sum(one.mountings for one in calibration.runs)
    lines += [
        f"{_count(len(calibration.runs), 'recording')}, {_count(mountings, 'mounting')}; {starts}",
        "",
        "Measuring chains (measured over true; ± 95 %)",
    ]
    lines += [f"  {channel:<12} {_chain(calibration, channel)}" for channel in found.machine.channels]
    lines += ["", "The machine's own unbalance, on average over its mountings (± 95 %)"]
    for disc in found.machine.discs:
        value, error = _vector(calibration, f"disc.{disc.id}.unbalance", 0.0)
        lines.append(f"  {disc.id:<12} {_unbalance(value, error)}")
    lines += ["", "From mounting to mounting (rms)"]
    lines += [f"  {_moved(one.name, one.rms)}" for one in calibration.mounting]
    lines += ["", "Scatter (rms)"]
    lines += [f"  {_scatter(one.channel, one.rpm, one.rms)}" for one in calibration.scatter]
    if not calibration.gain_drift:
        lines += ["", "Later fits take the gains as constant; `--gain-drift 2` would allow for a drift of 2 %"]
    return "\n".join(lines)


def _chain(calibration: Calibration, channel: str) -> str:
    gain, error = _vector(calibration, f"probe.{channel}.gain", 1.0)
    run_out, other = _vector(calibration, f"probe.{channel}.run_out", 0.0)
    angle = np.degrees(np.angle(gain))
    uncertain = np.degrees(min(error / max(abs(gain), 1e-300), np.pi))
    words = f"gain {_within(abs(gain), error)}, phase {angle:+.1f} ± {uncertain:.1f}°"
    return f"{words}; run-out {_within(MICROMETRES * abs(run_out), MICROMETRES * other)} µm"


def _vector(calibration: Calibration, name: str, origin: float) -> tuple[complex, float]:
    """Return a complex parameter with the larger half width of its parts; what is not there is its origin, exactly."""
    if f"{name}.real" not in calibration.parameters:
        return complex(origin), 0.0
    places = [calibration.parameters.index(f"{name}.{part}") for part in ("real", "imaginary")]
    real, imaginary = (calibration.values[place] for place in places)
    error = max(calibration.covariance[place][place] for place in places) ** 0.5
    return complex(real, imaginary) + origin, CONFIDENCE_95 * error


def _within(value: float, half: float) -> str:
    """Return a value and its half width with as many decimals as two digits of the latter need."""
    decimals = min(MOST_DECIMALS, max(0, 1 - math.floor(math.log10(half)))) if half > 0.0 else MOST_DECIMALS
    return f"{value:.{decimals}f} ± {half:.{decimals}f}"


def _unbalance(value: complex, error: float) -> str:
    angle = np.degrees(np.angle(value)) % 360.0
    return f"{_within(GRAM_MILLIMETRES * abs(value), GRAM_MILLIMETRES * error)} g mm at {angle:.0f}°"


def _moved(name: str, rms: float) -> str:
    if describe(name).quantity == "unbalance":
        return f"{name:<28} {GRAM_MILLIMETRES * rms:.3g} g mm"
    return f"{name:<28} {MICROMETRES * rms:.3g} µm"


def _scatter(channel: str, rpm: float | None, rms: float) -> str:
    if rpm is None:
        return f"{channel:<12} in sweeps      {rms:.2g} times the document's noise"
    return f"{channel:<12} {rpm:8.0f} r/min  {MICROMETRES * rms:.3g} µm"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
