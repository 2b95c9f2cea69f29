"""Calibration of a machine: what runs with known unbalances have shown of it, from which every later fit starts."""

from collections.abc import Collection, Iterator
from typing import Annotated, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from estimator.field_types import Identifier, NotNegative, Part, Positive, Real, Text
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.parameter_description import describe

MOST_PARAMETERS = 400
"""Most parameters of a calibration."""
LEAST_CORRELATION_EIGENVALUE = -1e-9
"""Eigenvalue of the correlation matrix below which a covariance is none [-]; rounding leaves some that are nearly zero."""

MOST_DRIFT = 0.5
"""Largest drift of gains beside which a calibration says anything of them [-]."""
LASTING = frozenset({"probe", "material", "disc"})
"""Kinds of elements whose parameters a fault of a bearing or a coupling leaves as they are."""
GainDrift = Annotated[
    NotNegative,
    Field(le=MOST_DRIFT, description="rms change of each channel's gain until a later run, in parts of it [-]"),
]
CovarianceRow = Annotated[tuple[Real, ...], Field(max_length=MOST_PARAMETERS, fail_fast=True)]
CalibratedName = Annotated[Text, Field(min_length=1, max_length=200)]


class ChannelScatter(Part):
    """Scatter of a channel's phasors about the calibrated model, at constant speed or in sweeps."""

    channel: Identifier
    rpm: Positive | None = Field(default=None, description="speed of the dwells [r/min]; in sweeps at all speeds")
    rms: Positive = Field(description="rms of the complex error 0-to-peak [m]; of sweeps a factor on the document's noise [-]")


class MountingSpread(Part):
    """Spread of something from one mounting of the machine to the next."""

    name: CalibratedName = Field(description="of the parameter: disc.D1.unbalance [kg m] or probe.P1X.run_out [m]")
    rms: NotNegative = Field(description="rms of the complex difference [kg m or m]")


class CalibrationRunRecord(Part):
    """Provenance of a calibration: one of its recordings."""

    name: CalibratedName = Field(description="of the recording")
    samples: Annotated[int, Field(ge=1)] = Field(description="number of its samples")
    mountings: Annotated[int, Field(ge=1)] = Field(description="number of times that weights were remounted in it")
    sha256: Annotated[str, Field(pattern=r"^([0-9a-f]{64})?$")] = Field(default="", description="of the recording's file")


class Calibration(Part):
    """Values of parameters with their joint covariance, and what varies beside them.

    Parameters are the real coordinates of a fit: positive ones as logarithms, complex ones as `.real` and `.imaginary`.
    """

    parameters: Annotated[tuple[CalibratedName, ...], Field(min_length=1, max_length=MOST_PARAMETERS, fail_fast=True)] = Field(
        description="names of the coordinates, in the order of `values`"
    )
    values: CovarianceRow = Field(description="[SI, logarithms of positive ones]")
    covariance: Annotated[tuple[CovarianceRow, ...], Field(max_length=MOST_PARAMETERS, fail_fast=True)] = Field(
        description="[products of their units]"
    )
    unbalances: Annotated[tuple[CalibratedName, ...], Field(max_length=MOST_PARAMETERS, fail_fast=True)] = Field(
        default=(), description="parameters that later fits find anew: the machine's own"
    )
    mounting: Annotated[tuple[MountingSpread, ...], Field(max_length=300)] = ()
    scatter: Annotated[tuple[ChannelScatter, ...], Field(max_length=2000)] = ()
    runs: Annotated[tuple[CalibrationRunRecord, ...], Field(max_length=1000)] = ()
    gain_drift: GainDrift = 0.0
    verdict: Annotated[Text, Field(max_length=4000)] = Field(default="", description="what the calibration said of its fit")

    def moved_since(self, variation: HealthyVariation) -> NDArray[np.float64]:
        """Return the variance (n,) by which each parameter differs in a later run of the healthy machine.

        It was mounted anew, gains drifted, and coefficients vary from run to run.

        Args:
            variation: Variation of the healthy machine.

        Returns:
            Variances (n,) [squares of the parameters' units].
        """
        rms = {f"{one.name}.{part}": one.rms for one in self.mounting for part in ("real", "imaginary")}
        moved = np.array([rms.get(name, 0.0) ** 2 / 2.0 for name in self.parameters])
        for gain, places in self._gains():
            moved[places] += (self.gain_drift * abs(gain)) ** 2 / 2.0
        return moved + self.between_runs(variation)

    def between_runs(self, variation: HealthyVariation) -> NDArray[np.float64]:
        """Return the variance of coefficients of bearings, couplings and pedestals from run to run.

        Args:
            variation: Variation of the healthy machine.

        Returns:
            Variances (n,), 0 of other parameters [squares of the parameters' units].
        """
        by_order = (variation.stiffness, variation.damping)
        found = np.zeros(len(self.parameters))
        for row, (name, value) in enumerate(zip(self.parameters, self.values, strict=True)):
            term = describe(name).term
            if term is not None and term.order < len(by_order):
                found[row] = (by_order[term.order] * (1.0 if term.direct else value)) ** 2
        return found

    def of_parameters(self, names: Collection[str]) -> "Calibration | None":
        """Return what it holds of some of its parameters: the marginal of its joint Gaussian.

        Args:
            names: Names of the parameters to keep.

        Returns:
            The calibration; None where it holds none of them.
        """
        rows = [row for row, name in enumerate(self.parameters) if name in names]
        if not rows:
            return None
        return self.model_copy(
            update={
                "parameters": tuple(self.parameters[row] for row in rows),
                "values": tuple(self.values[row] for row in rows),
                "covariance": tuple(tuple(self.covariance[row][other] for other in rows) for row in rows),
            }
        )

    def _gains(self) -> Iterator[tuple[complex, list[int]]]:
        """Yield each channel's gain and the places of its parts."""
        index = {name: place for place, name in enumerate(self.parameters)}
        for name, place in index.items():
            described = describe(name)
            other = index.get(f"{described.element}.gain.imaginary")
            if (described.quantity, described.component) == ("gain", "real") and other is not None:
                yield complex(1.0 + self.values[place], self.values[other]), [place, other]

    @model_validator(mode="after")
    def _whole(self) -> Self:
        count = len(self.parameters)
        if len(set(self.parameters)) != count:
            raise ValueError("a parameter stands more than once in the calibration")
        if len(self.values) != count or len(self.covariance) != count or any(len(row) != count for row in self.covariance):
            raise ValueError(f"{count} parameters need {count} values and a covariance of {count} rows and columns")
        covariance = np.array(self.covariance)
        size = np.sqrt(np.maximum(np.diag(covariance), 0.0))
        if not np.all(size > 0.0) or not np.allclose(covariance, covariance.T, rtol=1e-6, atol=0.0):
            raise ValueError("a covariance is symmetric, with variances above zero")
        if float(np.linalg.eigvalsh(covariance / np.outer(size, size)).min()) < LEAST_CORRELATION_EIGENVALUE:
            raise ValueError("the covariance is not positive definite: it was changed by hand or cut short")
        return self
