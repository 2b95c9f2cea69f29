"""Model of all bearings of a train by their oil films: coefficients over speed from clearances, viscosities and elevations.

The loads on the films follow from the statics of the whole train, so that one model gives the coefficients of all bearings.
Equilibria are solved at a few speeds, with exact derivatives; between them coefficients follow splines. Films of real
bearings deviate from any model by some per cent: each term may be off by a Gaussian process over speed (Kennedy and O'Hagan,
J. R. Stat. Soc. B 63 (2001) 425, doi:10.1111/1467-9868.00294), whose numbers are fitted with the others and told to nobody.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NoReturn

import numpy as np
from scipy.interpolate import CubicSpline

from estimator.arrays import Floats
from estimator.bearings.deviation_shapes import DeviationShapes
from estimator.bearings.journal import DEVIATING, JournalForm
from estimator.bearings.model import ModelParameter
from estimator.bearings.terms import LATERAL
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.quantities import UNITS
from estimator.statics.equilibrium import FilmEquilibrium, FilmTrain, film_train
from estimator.statics.film_sensitivity import PARAMETERS, film_sensitivity
from estimator.statics.films_over_speed import equilibria_near
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s

SPEEDS = 12
"""Number of speeds at which equilibria are solved."""
TERMS = tuple(term.name for term in LATERAL)
"""Terms of a bearing in the order of a film's matrices: stiffness by rows, then damping."""
LEVELS = ("all.stiffness_deviation", "all.damping_deviation")
"""Deviations that the direct terms of all films share at every speed: a solver, or an oil, is off for all of them alike."""
SHARED = 0.4
"""Part of a deviation's variance that is shared so [-]."""
LEFT_OUT = 0.001
"""Part of a deviation's variance that its left-out shapes may hold [-]: less than noise of 1 % shows."""
OWN = len(PARAMETERS)
"""Number of a film's own parameters."""


class FilmTooThin(Invalid):
    """Raised when a film of the document does not carry its journal at a speed at which the machine is watched."""


@dataclass(frozen=True)
class FilmModel:
    """The 8n coefficients of n films as functions of 4n parameters and of their deviations.

    Attributes:
        train: The train on its films as the document gives them.
        forms: Form of each bearing.
        slowest: Lowest speed of the document at which all films carry [rad/s].
        fastest: Highest one [rad/s].
        constant: False.
    """

    train: FilmTrain
    forms: tuple[JournalForm, ...]
    slowest: float
    fastest: float
    constant: bool = False

    @cached_property
    def coefficients(self) -> tuple[str, ...]:
        """Return the names of the 8n coefficients."""
        return tuple(f"bearing.{one.name}.{term}" for one in self.train.bearings for term in TERMS)

    @cached_property
    def parameters(self) -> tuple[ModelParameter, ...]:
        """Return the parameters: clearance, viscosity and elevation of each film, then the deviations of each."""
        own = [parameter for number in range(len(self.forms)) for parameter in self._own(number)]
        return (*own, *self._deviations())

    def _own(self, number: int) -> Sequence[ModelParameter]:
        bearing, form = self.train.bearings[number], self.forms[number]
        element, said = f"bearing.{bearing.name}", bearing.said
        step = form.elevation_spread or 1e-9
        held = 1e-6  # what is said to be exact
        return (
            ModelParameter(
                f"{element}.clearance",
                "clearance",
                UNITS["clearance"],
                True,
                said.radial_clearance,
                said.radial_clearance,
                form.clearance_spread or held,
            ),
            ModelParameter(
                f"{element}.viscosity",
                "viscosity",
                UNITS["viscosity"],
                True,
                bearing.viscosity,
                bearing.viscosity,
                form.viscosity_spread or held,
            ),
            ModelParameter(f"{element}.elevation_x", "elevation", UNITS["elevation"], False, said.elevation_x, step, 1.0),
            ModelParameter(f"{element}.elevation_y", "elevation", UNITS["elevation"], False, said.elevation_y, step, 1.0),
        )

    def _deviations(self) -> list[ModelParameter]:
        """Return the numbers of the films' deviations: those of each term's shapes, then the levels that all films share."""
        deviating = [one.name for one, form in zip(self.train.bearings, self.forms, strict=True) if form.discrepancy > 0.0]
        names = [
            f"{name}.{term}_deviation{shape}" for name in deviating for term in DEVIATING for shape in range(self.shapes.count)
        ]
        names += LEVELS if deviating else ()
        return [ModelParameter(f"films.{name}", "scale factor", "1", False, 0.0, 1.0, 1.0, nuisance=True) for name in names]

    @cached_property
    def films(self) -> "SolvedFilms":
        """Return the films at the speeds at which they are solved."""
        return SolvedFilms(self)

    @cached_property
    def shapes(self) -> DeviationShapes:
        """Return the shapes that deviations have over speed."""
        return DeviationShapes(self.slowest, self.fastest, left_out=LEFT_OUT)

    def at(self, speed: Floats) -> "FilmCurves":
        """Return the curves at some speeds; beyond the document's range they are level.

        Args:
            speed: Spin speeds (S,), without sign [rad/s].

        Returns:
            The curves.
        """
        return FilmCurves(self, np.clip(speed, self.slowest, self.fastest))

    def level(self, fitted: Floats) -> NoReturn:  # noqa: ARG002 - whatever they are
        """Return no parameters: a film's coefficients are not the same at every speed.

        Args:
            fitted: Fitted numbers (C,) of the constant coefficients [-].

        Returns:
            Nothing, ever.

        Raises:
            ValueError: Always.
        """
        raise ValueError("coefficients of oil films follow the speed and cannot be constant")

    def changed(self, fitted: Floats) -> FilmTrain:
        """Return the train with other films.

        Args:
            fitted: Fitted numbers of the own parameters (4n, ...) [-].

        Returns:
            The train.
        """
        own = fitted[: OWN * len(self.forms)].reshape(-1, OWN)
        bearings = tuple(
            replace(
                one,
                said=one.said.model_copy(update={"radial_clearance": one.said.radial_clearance * float(np.exp(theta[0]))}),
                viscosity=one.viscosity * float(np.exp(theta[1])),
            )
            for one, theta in zip(self.train.bearings, own, strict=True)
        )
        said = np.array([(one.said.elevation_x, one.said.elevation_y) for one in self.train.bearings])
        return FilmTrain(self.train.statics, bearings, self.train.elevation - said + own[:, 2:] * self.elevation_unit[:, None])

    @cached_property
    def elevation_unit(self) -> Floats:
        """Return the unit of each bearing's fitted elevations (n,) [m]."""
        return np.array([self.parameters[OWN * number + 2].step for number in range(len(self.forms))])


class SolvedFilms:
    """Films at the speeds at which equilibria are solved, remembered for the last fitted numbers.

    Attributes:
        speed: The speeds (G,), ascending [rad/s].
    """

    def __init__(self, model: FilmModel) -> None:
        """Solve for the equilibria that the document says.

        Args:
            model: The model.

        Raises:
            FilmTooThin: There is none at a speed.
        """
        self._model = model
        self.speed = np.geomspace(model.slowest, model.fastest, SPEEDS)
        nominal = model.train.over(self.speed)
        for speed, one in zip(self.speed.tolist(), nominal, strict=True):
            if one is None:
                raise FilmTooThin(
                    f"at {rad_per_s_to_rpm(speed):.0f} r/min a journal would be within a twentieth of the clearance of its "
                    "bearing: are geometry and oil right? Below the speed at which films carry, give valid_above_rpm"
                )
        self._last, self._found = model.train, nominal
        self._solved: tuple[bytes, tuple[FilmEquilibrium, ...] | None] = (b"", None)
        self._slopes: tuple[bytes, Floats] = (b"", np.zeros(0))

    def coefficients(self, fitted: Floats) -> Floats:
        """Compute the films' own coefficients.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficients (G, 8n) [SI]; NaN where a film is too thin.
        """
        found = self.equilibria(fitted)
        if found is None:
            return np.full((self.speed.size, 8 * len(self._model.forms)), np.nan)
        return np.stack([_row(one.stiffness, one.damping) for one in found])

    def equilibria(self, fitted: Floats) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria at these speeds.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            The equilibria; None where a film is too thin.
        """
        own = fitted[: OWN * len(self._model.forms)]
        key = own.tobytes()
        if self._solved[0] != key:
            self._solved = key, self._solve(own)
        return self._solved[1]

    def _solve(self, own: Floats) -> tuple[FilmEquilibrium, ...] | None:
        train = self._model.changed(own)
        found = self._near(train)
        if found is None:
            one_by_one = tuple(one for one in train.over(self.speed) if one is not None)
            found = one_by_one if len(one_by_one) == self.speed.size else None
        if found is not None:
            self._last, self._found = train, found
        return found

    def _near(self, train: FilmTrain) -> tuple[FilmEquilibrium, ...] | None:
        """Return the equilibria near the last ones, at the same parts of the clearances; None where there are none."""
        start = np.stack([one.position for one in self._found if one is not None])
        pairs = zip(train.bearings, self._last.bearings, strict=True)
        return equilibria_near(train, self.speed, start * np.array([[new.clearance / old.clearance] for new, old in pairs]))

    def slopes(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the films' own coefficients by their own fitted numbers.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Derivatives (G, 8n, 4n) [SI].
        """
        own = fitted[: OWN * len(self._model.forms)]
        key = own.tobytes()
        if self._slopes[0] != key:
            found = self.equilibria(fitted)
            count = own.size
            if found is None:
                slopes = np.full((self.speed.size, 2 * count, count), np.nan)
            else:
                train = self._model.changed(own)
                each = [film_sensitivity(train, one) for one in found]
                slopes = np.stack(
                    [np.stack([_row(k, c) for k, c in zip(one.stiffness, one.damping, strict=True)], axis=-1) for one in each]
                )
                unit = np.ones(count)
                unit.reshape(-1, OWN)[:, 2:] = self._model.elevation_unit[:, None]
                slopes = slopes * unit
            self._slopes = key, slopes
        return self._slopes[1]


class FilmCurves:
    """Coefficients of the films at S speeds."""

    def __init__(self, model: FilmModel, speed: Floats) -> None:
        """Prepare the interpolation.

        Args:
            model: The model.
            speed: Spin speeds (S,) within the model's range [rad/s].
        """
        self.model = model
        self.speed = speed
        self.weight = np.asarray(CubicSpline(np.log(model.films.speed), np.eye(SPEEDS))(np.log(speed)))
        self.shapes = model.shapes.at(speed)

    def values(self, fitted: Floats) -> Floats:
        """Compute the coefficients.

        Args:
            fitted: Fitted numbers (P,) [-].

        Returns:
            Coefficients (S, 8n) [SI]; NaN where a film is too thin.
        """
        base = self._base(fitted)
        if self.model.parameters[-1].nuisance:
            base = base + self._sizes(base) * self._relative(fitted)
        return base

    def derivatives(self, fitted: Floats, block: slice) -> Floats:
        """Compute the derivatives of the coefficients by the fitted numbers, at some of the speeds.

        Args:
            fitted: Fitted numbers (P,) [-].
            block: The s speeds.

        Returns:
            Derivatives (s, 8n, P) [SI].
        """
        base = self._base(fitted)[block]
        own = np.einsum("sg,gcp->scp", self.weight[block], self.model.films.slopes(fitted))
        if not self.model.parameters[-1].nuisance:
            return np.asarray(own)
        sizes, relative = self._sizes(base), self._relative(fitted)[block]
        first, second = self._beside
        growth = 0.5 * (own[:, first] / base[:, first, None] + own[:, second] / base[:, second, None])
        found = np.zeros((*base.shape, fitted.size))
        found[..., : own.shape[2]] = own + (sizes * relative)[..., None] * growth
        found[..., own.shape[2] :] = sizes[..., None] * self._by_deviation[block]
        return found

    def _base(self, fitted: Floats) -> Floats:
        """Return the films' own coefficients (S, 8n)."""
        return np.asarray(self.weight @ self.model.films.coefficients(fitted))

    def _sizes(self, base: Floats) -> Floats:
        """Return what a deviation of each coefficient is a part of (S, 8n): the direct terms beside it."""
        first, second = self._beside
        return np.asarray(np.sqrt(np.abs(base[:, first] * base[:, second])))

    @cached_property
    def _beside(self) -> tuple[list[int], list[int]]:
        pairs = [
            tuple(8 * number + TERMS.index(name) for name in term.beside)
            for number in range(len(self.model.forms))
            for term in LATERAL
        ]
        return [one[0] for one in pairs], [one[1] for one in pairs]

    @cached_property
    def _by_deviation(self) -> Floats:
        """Return the relative deviations (S, 8n, D) per unit of each of the D numbers [-]."""
        count, forms = self.shapes.shape[1], self.model.forms
        columns = [np.zeros((self.speed.size, 8 * len(forms), 0))]
        for number, form in enumerate(forms):
            if form.discrepancy == 0.0:
                continue
            part = np.zeros((self.speed.size, 8 * len(forms), count * len(DEVIATING)))
            for term, name in enumerate(TERMS):
                first = count * DEVIATING.index("cxy" if name == "cyx" else name)
                part[:, 8 * number + term, first : first + count] = form.discrepancy * np.sqrt(1.0 - SHARED) * self.shapes
            columns.append(part)
        if len(columns) > 1:
            levels = np.zeros((self.speed.size, 8 * len(forms), len(LEVELS)))
            for number, form in enumerate(forms):
                for term, one in enumerate(LATERAL):
                    if one.direct:
                        levels[:, 8 * number + term, one.order] = form.discrepancy * np.sqrt(SHARED)
            columns.append(levels)
        return np.concatenate(columns, axis=2)

    def _relative(self, fitted: Floats) -> Floats:
        """Return the relative deviations (S, 8n) [-]."""
        return np.asarray(self._by_deviation @ fitted[OWN * len(self.model.forms) :])


def film_model(machine: Machine) -> FilmModel:
    """Make the model of a machine's films.

    Args:
        machine: The machine, each bearing of which has a film and the form `journal`.

    Returns:
        The model.

    Raises:
        MissingFilm: A bearing says nothing of its film.
        UnsupportedShaft: Something would fall although all journals are held.
        InvalidSlenderness: A bearing has an impossible ratio of length to diameter.
    """
    forms = tuple(one.speed_dependence for one in machine.bearings if isinstance(one.speed_dependence, JournalForm))
    lifted = max((one.film.valid_above_rpm for one in machine.bearings if one.film is not None), default=0.0)
    slowest, fastest = max(machine.speed_range.minimum_rpm, lifted), machine.speed_range.maximum_rpm
    return FilmModel(film_train(machine), forms, rpm_to_rad_per_s(slowest), rpm_to_rad_per_s(fastest))


def _row(stiffness: Floats, damping: Floats) -> Floats:
    """Return matrices (n, 2, 2) of n films as one row (8n,)."""
    return np.concatenate([stiffness.reshape(-1, 4), damping.reshape(-1, 4)], axis=1).reshape(-1)
