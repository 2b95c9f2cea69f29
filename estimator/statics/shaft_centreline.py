"""Shaft centreline at the probes: where the mean gap says that the shaft stands, from the journals in their films.

A probe sees the shaft along its axis and stands on a pedestal, or on the ground. The journals rest at q = E + p - D (f - f0):
E where the bearings stand, p in their films, D what pedestals give way by under the forces f of the films. At rest the shafts
and couplings move with the journals as M q (as in `train_statics`), beside what weight and elevation add, which is the same at
every speed. So a probe along e sees e M (p - D f) from a zero of its own, and e D f more where its own pedestal gives way.
(Derived here; shaft centreline plots: Bently and Hatch, Fundamentals of Rotating Machinery Diagnostics, 2002, ch. 6.)
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import probe_rows
from estimator.statics.coupled_train import CoupledTrain, coupled_train
from estimator.statics.equilibrium import FilmEquilibrium
from estimator.statics.film_sensitivity import PARAMETERS
from estimator.statics.solved_films import SolvedFilms


@dataclass(frozen=True)
class ProbeLines:
    """Views of m probes on n journals.

    Attributes:
        by_position: Place of the shaft along each probe's axis per unit of each journal's position (m, n, 2) [-].
        by_force: The same per unit of each film's force on its journal (m, n, 2) [m/N].
    """

    by_position: Floats
    by_force: Floats

    def seen(self, position: Floats, force: Floats) -> Floats:
        """Compute what the probes see, from a zero of their own.

        Args:
            position: Positions (..., n, 2) of the journals in their bearings, or derivatives of them [m].
            force: Forces (..., n, 2) of the films on them, or derivatives of them [N].

        Returns:
            Places (..., m) of the shaft along the probes' axes, towards them [m].
        """
        own = np.einsum("mni,...ni->...m", self.by_position, position)
        return np.asarray(own + np.einsum("mni,...ni->...m", self.by_force, force))


@dataclass(frozen=True)
class ProbeViews:
    """Views of m probes on n journals over couplings and pedestals of any stiffness.

    Attributes:
        coupled: The train at rest.
        rows: What of all degrees of freedom each probe sees (m, N) [-].
        standing: Direction of the probe along x and y of the bearing on whose pedestal it stands, else 0 (m, 2n) [-].
    """

    coupled: CoupledTrain
    rows: Floats
    standing: Floats

    def at(self, factors: Floats) -> ProbeLines:
        """Compute the views (module's docstring).

        Args:
            factors: Factors (C,) on the expected stiffnesses of couplings and pedestals [-].

        Returns:
            The views.
        """
        motion, _ = self.coupled.motion(self.rows, factors)
        return self._lines(motion, (self.standing - motion) * self.coupled.compliances(factors))

    def slopes(self, factors: Floats) -> tuple[ProbeLines, ...]:
        """Compute the derivatives of the views by the logarithm of each factor.

        Args:
            factors: Factors (C,) on the expected stiffnesses of couplings and pedestals [-].

        Returns:
            C derivatives.
        """
        motion, by_factor = self.coupled.motion(self.rows, factors)
        compliance = self.coupled.compliances(factors)
        softer = [np.where(self.coupled.under == number, -compliance, 0.0) for number in range(factors.size)]
        return tuple(
            self._lines(moved, -moved * compliance + (self.standing - motion) * own)
            for moved, own in zip(by_factor, softer, strict=True)
        )

    def _lines(self, by_position: Floats, by_force: Floats) -> ProbeLines:
        shape = len(self.rows), len(self.coupled.bearings), 2
        return ProbeLines(by_position.reshape(shape), by_force.reshape(shape))


def probe_views(machine: Machine) -> ProbeViews:
    """Derive what the probes of a machine see of its journals at rest (module's docstring).

    Args:
        machine: The machine.

    Returns:
        The probes' views.

    Raises:
        UnsupportedShaft: Something would fall although all journals are held.
    """
    standing = np.zeros((len(machine.probes), len(machine.bearings), 2))
    for row, probe in zip(standing, machine.probes, strict=True):
        pedestal = machine.pedestal_under(probe)
        if pedestal is not None:
            angle = np.deg2rad(probe.angle_deg)
            row[next(number for number, one in enumerate(machine.bearings) if one.id == pedestal.bearing)] = (
                np.cos(angle),
                np.sin(angle),
            )
    return ProbeViews(
        coupled_train(machine), probe_rows(machine, assemble_rotor(machine)), standing.reshape(len(standing), -1)
    )


class ShaftCentreline:
    """Places of the shaft at m probes and S speeds as functions of the P numbers that films follow from."""

    def __init__(self, films: SolvedFilms, views: ProbeViews, speed: Floats) -> None:
        """Prepare the interpolation between the speeds at which equilibria are solved.

        Args:
            films: The films at these.
            views: The probes' views.
            speed: Spin speeds (S,), without sign; beyond the films' range it is level [rad/s].
        """
        inside = np.clip(speed, films.nominal.slowest, films.nominal.fastest)
        self._weight = np.asarray(films.nominal.spline(np.log(inside)))
        self._films = films
        self._views = views

    def values(self, fitted: Floats) -> Floats:
        """Compute the places, from a zero of each probe's own.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Places (S, m) [m]; NaN where a film is too thin.
        """
        found = self._films.equilibria(fitted)
        if found is None:
            return np.full((len(self._weight), len(self._views.rows)), np.nan)
        lines = self._views.at(self._films.factors(fitted))
        return np.asarray(self._weight @ lines.seen(*_rest(found)))

    def derivatives(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the places by the films' own fitted numbers.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, m, P) [m].
        """
        (position, force), found = self._films.motions(fitted), self._films.equilibria(fitted)
        factors = self._films.factors(fitted)
        seen = self._views.at(factors).seen(np.moveaxis(position, -1, 1), np.moveaxis(force, -1, 1))
        if found is not None:
            for place, slope in enumerate(self._views.slopes(factors)):
                seen[:, place] += slope.seen(*_rest(found))
        return np.asarray(np.tensordot(self._weight, np.moveaxis(seen, 1, -1), 1))

    def by_viscosities(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the places by the logarithm of each film's own viscosity.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, m, n) [m]; NaN where a film is too thin.
        """
        found, count = self._films.sensitivity(fitted), len(self._views.coupled.bearings)
        if found is None:
            return np.full((len(self._weight), len(self._views.rows), count), np.nan)
        which = slice(PARAMETERS.index("viscosity"), len(PARAMETERS) * count, len(PARAMETERS))
        lines = self._views.at(self._films.factors(fitted))
        seen = lines.seen(found.position[:, which], found.force[:, which])
        return np.asarray(np.tensordot(self._weight, np.moveaxis(seen, 1, -1), 1))


def _rest(found: Sequence[FilmEquilibrium]) -> tuple[Floats, Floats]:
    """Return positions and forces (G, n, 2) of equilibria."""
    return np.stack([one.position for one in found]), np.stack([one.force for one in found])
