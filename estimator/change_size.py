"""How large a cause is, in what a person reckons in: per cent, degrees, micrometres, gram millimetres."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.deviation import element_of
from estimator.diagnosis import Cause, Reference
from estimator.parameter_description import is_direct

APART = 2.0
"""A coupling's lateral and angular stiffness have risen differently when they are so many standard errors apart."""


@dataclass(frozen=True)
class ChangeSize:
    """per_cent: of what the element was in the baseline; None where the cause has no size. quantities: what it is made of, by
    name with the unit at its end, such as `stiffness_per_cent`, `magnitude_g_mm`, `angle_deg`."""

    per_cent: float | None
    quantities: Mapping[str, float]


def change_size(cause: Cause, baseline: Reference, *, amplitude: Mapping[str, float]) -> ChangeSize:
    """The size of a cause against its baseline. amplitude: of the channels in the baseline [m]."""
    if cause.kind in ("misalignment", "coupling", "bearing"):
        return _of_coefficients(cause)
    if cause.kind == "unbalance":
        return _of_unbalance(cause, baseline)
    if cause.kind == "sensor" and cause.names:
        gain = _pairs(cause)[0]
        quantities = {"gain_per_cent": 100.0 * (abs(1.0 + gain) - 1.0), "phase_deg": math.degrees(np.angle(1.0 + gain))}
        return ChangeSize(100.0 * abs(gain), quantities)
    if cause.kind in ("run_out", "bow"):
        channels = [name.split(".")[1] for name in cause.names[::2]]
        sizes = np.abs(_pairs(cause))
        relative = [size / amplitude[channel] for size, channel in zip(sizes, channels, strict=True)]
        return ChangeSize(100.0 * max(relative), {"largest_um": 1e6 * float(sizes.max())})
    return ChangeSize(None, {})


def misalignment_form(cause: Cause) -> str | None:
    """`parallel`, `angular` or `combined`, as far as the rise of a coupling's lateral and angular stiffness tells them apart.

    A parallel offset bends the coupling's elements sideways, an angular one tilts them (thesis §5.7): what has risen clearly
    more says which it is. None where the data do not tell.
    """
    own = [name.startswith(f"{cause.element}.") for name in cause.names]
    terms = [name.partition("@")[0].rsplit(".", 1)[-1] for name in cause.names]
    lateral = _mean_of([mine and term in ("kxx", "kyy") for mine, term in zip(own, terms, strict=True)])
    angular = _mean_of([mine and term in ("k_phix", "k_phiy") for mine, term in zip(own, terms, strict=True)])
    if not lateral.any() or not angular.any():
        return None
    rises = np.stack([lateral, angular])
    value, spread = rises @ cause.change, rises @ cause.covariance @ rises.T
    error = np.sqrt(np.diag(spread))
    difference = float(value[0] - value[1])
    apart = math.sqrt(max(0.0, float(spread[0, 0] + spread[1, 1] - 2.0 * spread[0, 1])))
    if apart > 0.0 and abs(difference) > APART * apart:
        return "parallel" if difference > 0.0 else "angular"
    # Where one was not measured by itself, the two only rise together because they are believed to.
    measured = apart < float(min(value)) and bool(np.all(value > APART * error))
    return "combined" if measured else None


def _of_coefficients(cause: Cause) -> ChangeSize:
    found: dict[str, float] = {}
    sizes = []
    for element in dict.fromkeys(element_of(name) for name in cause.names):
        for what, first in (("stiffness", "k"), ("damping", "c")):
            which = _mean_of(
                [element_of(name) == element and is_direct(name) and _term(name).startswith(first) for name in cause.names]
            )
            if not which.any():
                continue
            value, error = float(which @ cause.change), math.sqrt(float(which @ cause.covariance @ which))
            found[f"{element}.{what}_per_cent"] = 100.0 * math.expm1(value)
            if cause.kind != "misalignment" or what == "stiffness":
                sizes.append((abs(value) / max(error, 1e-12), 100.0 * math.expm1(value)))
    if cause.kind == "misalignment":
        return ChangeSize(float(np.mean([size for _, size in sizes])), found)
    return ChangeSize(max(sizes)[1] if sizes else None, found)


def _of_unbalance(cause: Cause, baseline: Reference) -> ChangeSize:
    change = complex(_pairs(cause)[0])
    before = complex(*(baseline.mean[baseline.names.index(name)] for name in cause.names))
    after = before + change
    quantities = {
        "change_g_mm": 1e6 * abs(change),
        "change_deg": math.degrees(np.angle(change)),
        "before_g_mm": 1e6 * abs(before),
        "after_g_mm": 1e6 * abs(after),
        "after_deg": math.degrees(np.angle(after)),
    }
    return ChangeSize(100.0 * abs(change) / max(abs(before), 1e-300), quantities)


def _pairs(cause: Cause) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    """The complex changes of quantities that come as real and imaginary part, one after the other."""
    return np.asarray(cause.change[::2] + 1j * cause.change[1::2])


def _term(name: str) -> str:
    return name.partition("@")[0].rsplit(".", 1)[-1]


def _mean_of(which: Sequence[bool]) -> Floats:
    chosen = np.array(which, dtype=float)
    return np.asarray(chosen / max(1.0, float(chosen.sum())))
