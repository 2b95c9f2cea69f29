"""Text of a calibration for a terminal or a notebook."""

import numpy as np

from estimator.calibration.calibrate import Calibrated
from estimator.machine.calibration import Calibration
from estimator.machine.parameter_description import describe

GRAM_MILLIMETRES = 1e6
"""g mm per kg m."""
MICROMETRES = 1e6
"""µm per m."""


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
        "Measuring chains (measured over true)",
    ]
    lines += [f"  {channel:<12} {_chain(calibration, channel)}" for channel in found.machine.channels]
    lines += ["", "The machine's own unbalance, on average over its mountings"]
    for disc in found.machine.discs:
        value, error = _vector(calibration, f"disc.{disc.id}.unbalance", 0.0)
        lines.append(f"  {disc.id:<12} {_unbalance(value, error)}")
    lines += ["", "From mounting to mounting (rms)"]
    lines += [f"  {_moved(one.name, one.rms)}" for one in calibration.mounting]
    lines += ["", "Scatter (rms)"]
    lines += [f"  {_scatter(one.channel, one.rpm, one.rms)}" for one in calibration.scatter]
    return "\n".join(lines)


def _chain(calibration: Calibration, channel: str) -> str:
    gain, error = _vector(calibration, f"probe.{channel}.gain", 1.0)
    run_out, other = _vector(calibration, f"probe.{channel}.run_out", 0.0)
    angle = np.degrees(np.angle(gain))
    uncertain = np.degrees(min(error / max(abs(gain), 1e-300), np.pi))
    words = f"gain {abs(gain):.4f} ± {error:.2g}, phase {angle:+.1f} ± {uncertain:.1f}°"
    return f"{words}; run-out {MICROMETRES * abs(run_out):.3f} ± {MICROMETRES * other:.2g} µm"


def _vector(calibration: Calibration, name: str, origin: float) -> tuple[complex, float]:
    """Return a complex parameter with the larger standard error of its parts; what is not there is its origin, exactly."""
    if f"{name}.real" not in calibration.parameters:
        return complex(origin), 0.0
    places = [calibration.parameters.index(f"{name}.{part}") for part in ("real", "imaginary")]
    real, imaginary = (calibration.values[place] for place in places)
    error = max(calibration.covariance[place][place] for place in places) ** 0.5
    return complex(real, imaginary) + origin, error


def _unbalance(value: complex, error: float) -> str:
    angle = np.degrees(np.angle(value)) % 360.0
    return f"{GRAM_MILLIMETRES * abs(value):.2f} ± {GRAM_MILLIMETRES * error:.2g} g mm at {angle:.0f}°"


def _moved(name: str, rms: float) -> str:
    if describe(name).quantity == "unbalance":
        return f"{name:<28} {GRAM_MILLIMETRES * rms:.3g} g mm"
    return f"{name:<28} {MICROMETRES * rms:.3g} µm"


def _scatter(channel: str, rpm: float | None, rms: float) -> str:
    if rpm is None:
        return f"{channel:<12} in sweeps      {rms:.2g} times the document's noise"
    return f"{channel:<12} {rpm:8.0f} rpm  {MICROMETRES * rms:.3g} µm"


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
