"""Values of a calibration by parameter, in SI units: logarithms and parts of complex parameters as what they stand for."""

import math
from collections.abc import Iterator
from typing import Any

from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.calibration import Calibration
from estimator.machine.parameter_description import SCALE_FACTORS, ParameterDescription, describe
from estimator.quantities import UNITS

CALIBRATED_COLUMNS = (
    "element",
    "quantity",
    "value",
    "standard_error",
    "lower",
    "upper",
    "imaginary",
    "imaginary_standard_error",
    "unit",
)
"""Columns of a data frame of calibrated parameters."""
SI_UNITS = {str(quantity): unit for quantity, unit in UNITS.items()}
"""SI unit of each quantity."""
ORIGIN = {"gain": 1.0}
"""Value that a calibrated number is counted from: measured over true."""


def calibrated_rows(calibration: Calibration) -> Iterator[dict[str, Any]]:
    """Yield each parameter of a calibration with its standard error and 95 % interval; of a complex one that of the magnitude.

    Args:
        calibration: The calibration.

    Yields:
        Columns of a data frame by name.
    """
    for place, name in enumerate(calibration.parameters):
        what = describe(name)
        if what.component == "imaginary":
            continue
        error = math.sqrt(calibration.covariance[place][place])
        value = calibration.values[place] + ORIGIN.get(what.quantity, 0.0)
        plain = name.removesuffix(".real")
        quantity = _quantity(what)
        common = {"parameter": plain, "element": what.element, "quantity": quantity, "unit": SI_UNITS[quantity]}
        if what.component == "real":
            other = calibration.parameters.index(f"{plain}.imaginary")
            imaginary, its_error = calibration.values[other], math.sqrt(calibration.covariance[other][other])
            size, half = math.hypot(value, imaginary), CONFIDENCE_95 * max(error, its_error)
            numbers: tuple[float | None, ...] = (value, error, max(size - half, 0.0), size + half, imaginary, its_error)
        elif what.positive:
            size, ratio = math.exp(value), math.exp(CONFIDENCE_95 * error)
            numbers = (size, size * error, size / ratio, size * ratio, None, None)
        else:
            half = CONFIDENCE_95 * error
            numbers = (value, error, value - half, value + half, None, None)
        yield common | dict(zip(CALIBRATED_COLUMNS[2:-1], numbers, strict=True))


def _quantity(what: ParameterDescription) -> str:
    """Return the physical quantity of a parameter, as estimates have it."""
    if what.quantity in SCALE_FACTORS:
        return "scale factor"
    return what.physical_quantity or what.quantity.replace("run_out", "run-out").replace("_", " ")
