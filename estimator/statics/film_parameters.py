"""Clearance, viscosity and elevation of each film of a train as parameters of a fit, and the train that they make."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.journal import JournalForm
from estimator.bearings.model import ModelParameter
from estimator.quantities import UNITS
from estimator.statics.equilibrium import FilmTrain
from estimator.statics.film_sensitivity import PARAMETERS

OWN = len(PARAMETERS)
"""Number of a film's own parameters."""
HELD = 1e-6
"""Spread of the logarithm of what is said to be exact [-]."""


@dataclass(frozen=True)
class FilmParameters:
    """The 4n own parameters of n films.

    Attributes:
        train: The train on its films as the document gives them.
        forms: Form of each bearing, which states how far its parameters may be off.
    """

    train: FilmTrain
    forms: tuple[JournalForm, ...]

    @property
    def count(self) -> int:
        """Return the number of parameters, 4n."""
        return OWN * len(self.forms)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the parameters, film by film in the order of `film_sensitivity.PARAMETERS`."""
        return tuple(parameter for number in range(len(self.forms)) for parameter in self._of_film(number))

    def _of_film(self, number: int) -> Sequence[ModelParameter]:
        bearing, form = self.train.bearings[number], self.forms[number]
        element, said = f"bearing.{bearing.name}", bearing.said
        step = form.elevation_spread or 1e-9
        return (
            ModelParameter(
                f"{element}.clearance",
                "clearance",
                UNITS["clearance"],
                True,
                said.radial_clearance,
                said.radial_clearance,
                form.clearance_spread or HELD,
            ),
            ModelParameter(
                f"{element}.viscosity",
                "viscosity",
                UNITS["viscosity"],
                True,
                bearing.viscosity,
                bearing.viscosity,
                form.viscosity_spread or HELD,
            ),
            ModelParameter(f"{element}.elevation_x", "elevation", UNITS["elevation"], False, said.elevation_x, step, 1.0),
            ModelParameter(f"{element}.elevation_y", "elevation", UNITS["elevation"], False, said.elevation_y, step, 1.0),
        )

    def of(self, fitted: Floats) -> Floats:
        """Return the films' own fitted numbers among all of a model.

        Args:
            fitted: Fitted numbers (P,), the own ones first [-].

        Returns:
            Fitted numbers (4n,) [-].
        """
        return fitted[: self.count]

    def changed(self, fitted: Floats) -> FilmTrain:
        """Return the train with other films.

        Args:
            fitted: Fitted numbers (P,), the 4n own ones first [-].

        Returns:
            The train.
        """
        own = self.of(fitted).reshape(-1, OWN)
        bearings = tuple(
            replace(
                one,
                said=one.said.model_copy(update={"radial_clearance": one.said.radial_clearance * float(np.exp(theta[0]))}),
                viscosity=one.viscosity * float(np.exp(theta[1])),
            )
            for one, theta in zip(self.train.bearings, own, strict=True)
        )
        said = np.array([(one.said.elevation_x, one.said.elevation_y) for one in self.train.bearings])
        units = self.unit.reshape(-1, OWN)[:, 2:]
        return FilmTrain(self.train.statics, bearings, self.train.elevation - said + own[:, 2:] * units)

    @cached_property
    def unit(self) -> Floats:
        """Return the units of the fitted numbers (4n,) [1 of logarithms, m]."""
        return np.array([one.step for one in self.parameters])
