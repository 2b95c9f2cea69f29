"""Coefficients of journal bearings from their oil films, whose geometry, oil and elevation the document gives.

A film's coefficients depend on the load that the whole train puts on it, so that this form makes no model of one bearing
alone: it declares the one of all films of a train, which `estimator.statics.film_model` makes. Bearings of other forms may
stand beside them: they carry what their own stiffness makes of it.
"""

from collections.abc import Sequence
from typing import ClassVar, Literal

from pydantic import Field

from estimator.bearings.defaults import FormDefaults
from estimator.bearings.model import CoefficientModel, ModelParameter, OwnParameter, WholeTrain
from estimator.bearings.terms import LATERAL
from estimator.field_types import ElevationSpread, Part, Spread
from estimator.quantities import UNITS

DEVIATING = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyy")
"""Terms of a film that deviate from its model each by itself; cyx deviates as cxy, to which it is equal in a film."""


class JournalForm(FormDefaults, Part):
    """Coefficients that follow from the oil film: the bearing's `film` gives geometry, oil and elevation.

    Clearance, viscosity and elevation of each bearing are determined, how viscosity falls with speed, and static loads on the
    shafts, with what the document says of them as a prior.
    """

    own_parameters: ClassVar[tuple[OwnParameter, ...]] = (
        OwnParameter("clearance", "clearance", UNITS["clearance"], positive=True),
        OwnParameter("viscosity", "viscosity", UNITS["viscosity"], positive=True),
        OwnParameter("viscosity_factor", "scale factor", UNITS["scale factor"], positive=True),
        OwnParameter("viscosity_ratio", "scale factor", UNITS["scale factor"], positive=True),
        OwnParameter("viscosity_slope", "slope", UNITS["slope"], positive=False),
        OwnParameter("elevation_x", "elevation", UNITS["elevation"], positive=False),
        OwnParameter("elevation_y", "elevation", UNITS["elevation"], positive=False),
        OwnParameter("force_x", "force", UNITS["force"], positive=False),
        OwnParameter("force_y", "force", UNITS["force"], positive=False),
    )

    whole_train: ClassVar[WholeTrain | None] = WholeTrain(
        model="estimator.statics.film_model:film_model",
        of="films",
        part="film",
        contents="diameter, length, radial_clearance [m] and oil",
    )

    form: Literal["journal"] = Field(description="coefficients that follow from the bearing's film")
    clearance_spread: Spread = Field(default=0.15, description="how far the radial clearance may be off, relative rms [-]")
    viscosity_spread: Spread = Field(default=0.15, description="how far the film's viscosity may be off, relative rms [-]")
    viscosity_ratio_spread: Spread = Field(
        default=0.0,
        description="how far the viscosity may differ from what the oil's supply makes of it, relative rms [-]; 0: not at all",
    )
    viscosity_slope_spread: Spread = Field(
        default=0.0,
        description="how far the slope of ln viscosity over ln speed may be off, rms [-]; 0: as the oil says",
    )
    elevation_spread: ElevationSpread = Field(
        default=1.5e-4, description="how far the bearing's centre may be from its elevation, rms, in each direction [m]"
    )
    discrepancy: Spread = Field(
        default=0.05, description="how far the film's coefficients may be from those of its model, relative rms [-]"
    )

    @property
    def coefficients(self) -> tuple[str, ...]:
        """Return all terms of the bearing: a film gives every one."""
        return tuple(term.name for term in LATERAL)

    def governs(self, term: str) -> bool:
        """Return whether a term is the film's: each is.

        Args:
            term: The term, such as `kxx`.

        Returns:
            Whether it is.
        """
        return term in self.coefficients

    def parameter_count(self, terms: Sequence[str]) -> int:
        """Return the number of parameters that a film has, which gives all terms together.

        Args:
            terms: The terms.

        Returns:
            The number.
        """
        return 4 + (self.viscosity_slope_spread > 0.0) + (self.viscosity_ratio_spread > 0.0) if terms else 0

    def models(self, coefficients: Sequence[ModelParameter]) -> Sequence[CoefficientModel]:  # noqa: ARG002
        """Return no models: the films of a train have one together.

        Args:
            coefficients: The coefficients as parameters.

        Returns:
            Nothing.
        """
        return ()
