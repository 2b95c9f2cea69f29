"""Bearing with coefficients of its own beside others on oil films: in the train at rest a support of a stiffness.

Its coefficients are those of small motions about where it stands when the train is aligned, under the load that it carries
then, whatever the speed. So the force on its journal is f = f₀ - K p, with p the way from there: as pedestals give way, beside
f₀ (`train_statics`). K follows the models of its coefficients: a number, a course over speed or a table, exact at each speed.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from estimator.arrays import Floats
from estimator.bearings.model import CoefficientModel, ModelParameter
from estimator.bearings.terms import LATERAL
from estimator.films.film import FilmCoefficients
from estimator.machine.films import Elevation
from estimator.rotor.coefficient_models import GoverningModel, governing_models
from estimator.rotor.parameters import Coefficient

STIFFNESSES = 4
"""Number of a bearing's terms that are stiffnesses, which come first."""


@dataclass(frozen=True)
class _SupportTerms:
    """Terms of a support that one model gives.

    Attributes:
        model: The model.
        columns: Their places among the model's coefficients.
        rows: Their places among the eight terms.
        first: Place of the model's first parameter among those of the support.
    """

    model: CoefficientModel
    columns: tuple[int, ...]
    rows: tuple[int, ...]
    first: int

    @property
    def numbers(self) -> slice:
        return slice(self.first, self.first + len(self.model.parameters))


@dataclass(frozen=True)
class LinearSupport:
    """A support of eight coefficients.

    Attributes:
        name: Id of the bearing.
        elevation: Where the document has its centre, and how far that may be off.
        load: Force (2,) on its journal where it stands when the train is aligned; shape (axis,) [N].
        fixed: Its eight coefficients (8,) as expected, which those that no model gives stay at; shape (term,) [SI].
        fitted: Fitted numbers (L,) of its models' parameters; shape (parameter,) [-].
    """

    name: str
    elevation: Elevation
    load: Floats
    fixed: Floats
    fitted: Floats
    _terms: tuple[_SupportTerms, ...]

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the L parameters of its models."""
        return tuple(parameter for one in self._terms for parameter in one.model.parameters)

    @property
    def expected(self) -> dict[str, float]:
        """Return its coefficients as the document has them by name, of a table those at the middle of the range [SI]."""
        return {f"bearing.{self.name}.{term.name}": float(one) for term, one in zip(LATERAL, self.fixed, strict=True)}

    @property
    def raised(self) -> tuple[float, float]:
        """Return where the document has its centre, over the aligned place, along x and y [m]."""
        return self.elevation.x, self.elevation.y

    @property
    def clearance(self) -> float:
        """Return infinity [m]: its journal may be anywhere."""
        return float("inf")

    @property
    def turns_sharply(self) -> bool:
        """Return False: its coefficients do not depend on where its journal is."""
        return False

    def changed(self, fitted: Floats) -> "LinearSupport":
        """Return the support with other numbers.

        Args:
            fitted: Fitted numbers (L,) of its models' parameters; shape (parameter,) [-].

        Returns:
            The support.
        """
        return replace(self, fitted=fitted)

    def covers(self, position: Floats) -> bool:  # noqa: ARG002 - anywhere
        """Return True: it carries its journal anywhere.

        Args:
            position: Position (2,) of the journal; shape (axis,) [m].

        Returns:
            True.
        """
        return True

    def at(self, position: Floats, *, speed: Floats | float) -> FilmCoefficients:
        """Compute force on the journal, stiffness and damping, as of a film.

        Args:
            position: Positions (..., 2) of the journal relative to where it stands aligned [m].
            speed: Spin speed, without sign (...) [rad/s].

        Returns:
            The force and the coefficients there.
        """
        values = self._coefficients(np.atleast_1d(np.asarray(speed, dtype=float)))
        place = np.asarray(position)
        shape = np.broadcast_shapes(np.shape(speed), place.shape[:-1])
        values = np.broadcast_to(values.reshape(*np.shape(speed), -1), (*shape, 2 * STIFFNESSES))
        stiffness, damping = (values[..., part].reshape(*shape, 2, 2) for part in _ORDERS)
        force = self.load - np.einsum("...ij,...j->...i", stiffness, place)
        nothing = np.zeros((*stiffness.shape, 2))
        return FilmCoefficients(force, stiffness, damping, nothing, nothing)

    def stiffness_slopes(self, speed: Floats) -> Floats:
        """Compute the derivatives of the stiffness by the fitted numbers of its parameters.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            Derivatives (S, L, 2, 2) [N/m].
        """
        found = np.zeros((speed.size, 2 * STIFFNESSES, len(self.parameters)))
        for one in self._terms:
            slopes = one.model.at(speed).derivatives(self.fitted[one.numbers], slice(None))
            found[:, one.rows, one.numbers] = slopes[:, one.columns]
        return np.moveaxis(found[:, _ORDERS[0]], 2, 1).reshape(speed.size, -1, 2, 2)

    def _coefficients(self, speed: Floats) -> Floats:
        """Return the eight coefficients at some speeds (S, 8)."""
        found = np.repeat(self.fixed[None], speed.size, axis=0)
        for one in self._terms:
            found[:, one.rows] = one.model.at(speed).values(self.fitted[one.numbers])[:, one.columns]
        return found


_ORDERS = slice(0, STIFFNESSES), slice(STIFFNESSES, 2 * STIFFNESSES)


def linear_support(
    name: str, elevation: Elevation | None, *, load: Floats, coefficients: Sequence[Coefficient]
) -> LinearSupport:
    """Make the support that a bearing with coefficients of its own is (`LinearSupport`).

    Source: own derivation: small motions about the aligned place, in the module's docstring.

    Args:
        name: Id of the bearing.
        elevation: What the document says of its elevation; None for nothing.
        load: Force (2,) on its journal where it stands when the train is aligned; shape (axis,) [N].
        coefficients: All coefficients of the train, some of which its own may be tied to.

    Returns:
        The support, as it is expected to be.
    """
    index = {one.name: k for k, one in enumerate(coefficients)}
    own = [coefficients[index[f"bearing.{name}.{term.name}"]] for term in LATERAL]
    leader = [index[one.name if one.tied_to is None else one.tied_to] for one in own]
    terms: list[_SupportTerms] = []
    count = 0
    for one in governing_models(coefficients):
        rows = tuple(row for row, k in enumerate(leader) if k in one.coefficients)
        if any(row < STIFFNESSES for row in rows):
            terms.append(_SupportTerms(one.model, _columns(one, [leader[row] for row in rows]), rows, count))
            count += len(one.model.parameters)
    centre = [parameter.centre for one in terms for parameter in one.model.parameters]
    expected = np.array([coefficients[k].expected for k in leader])
    return LinearSupport(name, elevation or Elevation(), load, expected, np.array(centre), tuple(terms))


def _columns(model: GoverningModel, coefficients: Sequence[int]) -> tuple[int, ...]:
    return tuple(model.coefficients.index(k) for k in coefficients)
