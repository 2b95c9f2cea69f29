"""Conversion of fit coordinates to estimates in SI units with intervals, or the reason why there is none."""

import math
from collections.abc import Callable, Iterator

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.bearings.model import ModelParameter
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.parameter_description import describe
from estimator.quantities import UNITS, Quantity
from estimator.rotor.condensation import CondensedTrain
from estimator.rotor.parameters import Coefficient, Excitation

CONFIDENCE_95 = 1.959964
"""Half width of a 95 % interval in standard errors."""
LARGEST_RELATIVE_ERROR = 1.0
"""Largest standard error of an estimable cross-coupled term or unbalance, as a part of its scale [-]."""
LARGEST_DIRECT_ERROR = 0.4
"""Largest standard error of an estimable direct term's logarithm [-]: beyond it the term may be zero, and its logarithm has no
sound interval.
"""
LARGEST_PRIOR_PART = 0.8
"""Largest standard error of an estimable level, as a part of that believed beforehand [-]."""

KEPT, TIED = ("kept at its nominal value", "as the document gives it over speed"), "tied to"
"""Beginnings of the reasons of coefficients that the document keeps, or ties to another's: the data were not asked."""

Common = tuple[str, str, str, str]
"""Name, element, quantity and unit of an estimate."""
UndeterminedReason = Callable[[str], str] | None
"""Function that says why the data leave the coordinate of that name open; None where nothing can say it."""


class Estimate(Struct, frozen=True):
    """One estimated parameter.

    A complex one has an imaginary part and its standard error beside the real one; lower and upper then bound the magnitude.

    Attributes:
        name: Name of the parameter.
        element: Name of its element.
        quantity: Physical quantity.
        unit: SI unit of the values.
        value: Value or real part [unit]; None where the data do not determine it.
        standard_error: Standard error of the value [unit]; None where the data do not determine it.
        lower: Lower end of the 95 % interval [unit]; None where the data do not determine it.
        upper: Upper end of the 95 % interval [unit]; None where the data do not determine it.
        imaginary: Imaginary part of a complex parameter [unit].
        imaginary_standard_error: Standard error of the imaginary part [unit].
        reason: Reason why there is no value.
    """

    name: str
    element: str
    quantity: str
    unit: str
    value: float | None
    standard_error: float | None
    lower: float | None
    upper: float | None
    imaginary: float | None = None
    imaginary_standard_error: float | None = None
    reason: str | None = None

    @property
    def estimable(self) -> bool:
        """Return whether the data determine this parameter."""
        return self.value is not None

    @property
    def sought(self) -> bool:
        """Return whether the data were asked for it: the document neither keeps its value nor ties it to another."""
        return self.reason is None or not self.reason.startswith((*KEPT, TIED))


def determined(coordinates: Coordinates, error: Floats) -> tuple[int, ...]:
    """List the coordinates of coefficients whose standard error alone does not rule an estimate out.

    Args:
        coordinates: Coordinates of the fit.
        error: Standard errors (n,) of the coordinates [-].

    Returns:
        Indices of the coordinates.
    """
    limits = [LARGEST_DIRECT_ERROR if one.positive else LARGEST_RELATIVE_ERROR for one in coordinates.parameters]
    return tuple(place for place, limit in enumerate(limits) if error[place] <= limit)


def estimates(
    train: CondensedTrain,
    coordinates: Coordinates,
    theta: Floats,
    error: Floats,
    reason: UndeterminedReason,
    doubtful: frozenset[int] = frozenset(),
) -> tuple[Estimate, ...]:
    """Convert fit coordinates to estimates of all parameters.

    Args:
        train: The condensed train.
        coordinates: Coordinates of the fit.
        theta: Fit coordinates θ (n,) [-].
        error: Standard errors (n,) of θ [-].
        reason: Function that says why a coordinate is left open, or None.
        doubtful: Coordinates whose interval the likelihood's profile does not confirm.

    Returns:
        Estimates of coefficients, excitations, scale factors and channels, with their units.
    """
    return (
        *_coefficients(train, coordinates, theta, error, reason, doubtful),
        *_excitations(train, coordinates, theta, error, reason),
        *_scale_factors(train, coordinates, theta, error),
        *_channels(train, coordinates, theta, error),
    )


def _coefficients(
    train: CondensedTrain,
    coordinates: Coordinates,
    theta: Floats,
    error: Floats,
    reason: UndeterminedReason,
    doubtful: frozenset[int],
) -> Iterator[Estimate]:
    values = coordinates.coefficients(theta)
    typical = values if values.ndim == 1 else np.exp(np.mean(np.log(np.abs(values) + 1e-300), axis=0))
    size = dict(zip((c.name for c in train.unknowns.coefficients), typical, strict=True))
    told: set[int] = set()
    for k, coefficient in enumerate(train.unknowns.coefficients):
        if coefficient.fixed:
            yield _not_estimated(coefficient, f"{KEPT[0]} {coefficient.nominal:g} {coefficient.unit}")
        elif coefficient.tied_to is not None:
            yield _not_estimated(coefficient, f"{TIED} {coefficient.tied_to}")
        elif not coordinates.places(k):
            yield _not_estimated(coefficient, f"{KEPT[1]}, which is taken as exact")
        else:
            for place in coordinates.places(k):
                if place in told:
                    continue  # a parameter of several coefficients is told once
                told.add(place)
                parameter = coordinates.parameters[place]
                if parameter.nuisance:
                    continue
                common = (parameter.name, describe(parameter.name).element, parameter.quantity, parameter.unit)
                if place in doubtful:
                    why = _reason_text(reason, parameter.name)
                    yield _estimate_without_value(common, f"the data leave it open far beyond its standard error{why}")
                    continue
                if _is_level(parameter) and prior_alone(float(error[place]), parameter.spread):
                    why = prior_alone_reason(parameter.step * parameter.spread, parameter.unit)
                    yield _estimate_without_value(common, why)
                    continue
                judged_by = parameter.scale if parameter.coefficient is None else comparison_size(coefficient, size)
                yield _parameter(parameter, common, float(theta[place]), float(error[place]), judged_by, reason)


def prior_alone(error: float, believed: float) -> bool:
    """Return whether the prior alone determines a level, such as an elevation or an offset: one that may be zero.

    Args:
        error: Its standard error [any unit].
        believed: Its standard deviation before the fit [that unit].

    Returns:
        Whether the data say hardly more of it than what was believed.
    """
    return error > LARGEST_PRIOR_PART * believed


def prior_alone_reason(believed: float, unit: str) -> str:
    """State that the prior alone determines a level.

    Args:
        believed: Its standard deviation before the fit [unit].
        unit: Its SI unit.

    Returns:
        The reason in words.
    """
    size, said = (1e6 * believed, f"µ{unit}") if unit in {"m", "rad"} else (believed, unit)
    return f"the data say hardly more of it than what is believed beforehand: ± {float(f'{size:.2g}'):g} {said}"


def _is_level(parameter: ModelParameter) -> bool:
    """Return whether a parameter is a level, such as an elevation: one that may be zero."""
    return not parameter.positive and parameter.coefficient is None


def comparison_size(coefficient: Coefficient, size: dict[str, float]) -> float:
    """Return the size that a coefficient's error is compared with: of a cross-coupled term, the direct terms beside it.

    A cross-coupled term's own value may well be zero.

    Args:
        coefficient: The coefficient.
        size: Magnitude of every coefficient by name [SI].

    Returns:
        Size [SI].
    """
    if coefficient.direct:
        return size[coefficient.name]
    first, second = (size[f"{coefficient.element}.{name}"] for name in coefficient.term.beside)
    return math.sqrt(first * second)


def _parameter(
    parameter: ModelParameter, common: Common, fitted: float, error: float, judged_by: float, reason: UndeterminedReason
) -> Estimate:
    """Build the estimate of a model's parameter from its fitted number and the standard error of that."""
    spread = parameter.step * error
    if parameter.positive:
        if spread > LARGEST_DIRECT_ERROR:
            limit = f"its standard error; {100 * LARGEST_DIRECT_ERROR:.0f} % at most"
            words = f"the data leave it uncertain by {100 * spread:.0f} % of its value ({limit})"
            return _estimate_without_value(common, words + _reason_text(reason, parameter.name))
        return _positive(common, parameter.expected * math.exp(fitted), spread)
    if spread > LARGEST_RELATIVE_ERROR * judged_by:
        part, why = 100 * spread / judged_by, _reason_text(reason, parameter.name)
        limit = f"its standard error; {100 * LARGEST_RELATIVE_ERROR:.0f} % at most"
        whole = "what is expected of it" if parameter.coefficient is None else "the direct terms of its element"
        return _estimate_without_value(common, f"the data leave it uncertain by {part:.0f} % of {whole} ({limit}){why}")
    value, half = parameter.step * fitted, CONFIDENCE_95 * spread
    return Estimate(*common, value, spread, value - half, value + half)


def _excitations(
    train: CondensedTrain, coordinates: Coordinates, theta: Floats, error: Floats, reason: UndeterminedReason
) -> Iterator[Estimate]:
    values = coordinates.excitations(theta)
    unbalances = np.abs(values[: len(train.unknowns.unbalances)])
    largest = float(np.max(unbalances, initial=0.0))
    for item, value, place in zip(train.unknowns.excitations, values, coordinates.excitation_place, strict=True):
        common = (item.name, item.element, item.quantity, item.unit)
        if place < 0:
            yield _not_estimated(item, f"kept at its nominal value {abs(value):g} {item.unit}")
            continue
        spread = coordinates.unit[place] * error[place : place + 2]
        if item.quantity == "unbalance" and float(np.max(spread)) > LARGEST_RELATIVE_ERROR * largest:
            yield _estimate_without_value(
                common,
                f"the data leave it uncertain by {float(np.max(spread)):.2g} kg m, more than the largest unbalance found"
                f"{_reason_text(reason, coordinates.names[place])}",
            )
        else:
            yield _complex(common, complex(value), spread)


def _scale_factors(train: CondensedTrain, coordinates: Coordinates, theta: Floats, error: Floats) -> Iterator[Estimate]:
    for one, place in zip(train.scale_factors, coordinates.scale_place, strict=True):
        common: Common = (one.name, one.element, "scale factor", UNITS["scale factor"])
        yield _positive(common, math.exp(float(theta[place])), float(error[place]))


def _channels(train: CondensedTrain, coordinates: Coordinates, theta: Floats, error: Floats) -> Iterator[Estimate]:
    quantities: tuple[tuple[str, Quantity, NDArray[np.intp]], ...] = (
        ("gain", "gain", coordinates.channels.gain),
        ("run_out", "run-out", coordinates.channels.run_out),
    )
    for what, quantity, places in quantities:
        values = coordinates.channels.gains(theta) if quantity == "gain" else coordinates.channels.run_outs(theta)
        for channel, value, place in zip(train.channels, values, places, strict=True):
            if place >= 0:
                element = f"probe.{channel}"
                common = (f"{element}.{what}", element, quantity, UNITS[quantity])
                yield _complex(common, complex(value), coordinates.unit[place] * error[place : place + 2])


def _positive(common: Common, value: float, error: float) -> Estimate:
    """Build the estimate of a direct term; `error` is of its logarithm, which makes the interval lopsided."""
    lower, upper = (value * math.exp(sign * CONFIDENCE_95 * error) for sign in (-1, 1))
    return Estimate(*common, value, value * error, lower, upper)


def _complex(common: Common, value: complex, error: Floats) -> Estimate:
    half = CONFIDENCE_95 * float(np.max(error))
    return Estimate(
        *common,
        value=value.real,
        standard_error=float(error[0]),
        lower=max(0.0, abs(value) - half),
        upper=abs(value) + half,
        imaginary=value.imag,
        imaginary_standard_error=float(error[1]),
    )


def _reason_text(reason: UndeterminedReason, name: str) -> str:
    return "" if reason is None else f": {reason(name)}"


def _not_estimated(item: Coefficient | Excitation, reason: str) -> Estimate:
    return _estimate_without_value((item.name, item.element, item.quantity, item.unit), reason)


def _estimate_without_value(common: Common, reason: str) -> Estimate:
    return Estimate(*common, None, None, None, None, reason=reason)
