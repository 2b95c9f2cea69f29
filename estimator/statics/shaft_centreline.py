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
from estimator.statics.equilibrium import FilmEquilibrium
from estimator.statics.film_sensitivity import PARAMETERS
from estimator.statics.solved_films import SolvedFilms
from estimator.statics.train_statics import pedestal_compliance, shaft_motion


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


def probe_lines(machine: Machine) -> ProbeLines:
    """Derive what the probes of a machine see of its journals at rest (module's docstring).

    Args:
        machine: The machine.

    Returns:
        The probes' views.

    Raises:
        UnsupportedShaft: Something would fall although all journals are held.
    """
    rows, compliance = probe_rows(machine, assemble_rotor(machine)), pedestal_compliance(machine)
    by_position = rows @ shaft_motion(machine)
    by_force = -by_position * compliance
    for row, probe in zip(by_force, machine.probes, strict=True):
        pedestal = machine.pedestal_under(probe)
        if pedestal is None:
            continue
        first = 2 * next(number for number, one in enumerate(machine.bearings) if one.id == pedestal.bearing)
        angle = np.deg2rad(probe.angle_deg)
        row[first : first + 2] += compliance[first : first + 2] * (np.cos(angle), np.sin(angle))
    shape = len(machine.probes), len(machine.bearings), 2
    return ProbeLines(by_position.reshape(shape), by_force.reshape(shape))


class ShaftCentreline:
    """Places of the shaft at m probes and S speeds as functions of the films' own P parameters."""

    def __init__(self, films: SolvedFilms, lines: ProbeLines, speed: Floats) -> None:
        """Prepare the interpolation between the speeds at which equilibria are solved.

        Args:
            films: The films at these.
            lines: The probes' views.
            speed: Spin speeds (S,), without sign; beyond the films' range it is level [rad/s].
        """
        inside = np.clip(speed, films.nominal.slowest, films.nominal.fastest)
        self._weight = np.asarray(films.nominal.spline(np.log(inside)))
        self._films = films
        self._lines = lines

    def values(self, fitted: Floats) -> Floats:
        """Compute the places, from a zero of each probe's own.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Places (S, m) [m]; NaN where a film is too thin.
        """
        found = self._films.equilibria(fitted)
        if found is None:
            return np.full((len(self._weight), len(self._lines.by_position)), np.nan)
        return np.asarray(self._weight @ self._lines.seen(_positions(found), np.stack([one.force for one in found])))

    def derivatives(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the places by the films' own fitted numbers.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, m, P) [m].
        """
        position, force = self._films.motions(fitted)
        seen = self._lines.seen(np.moveaxis(position, -1, 1), np.moveaxis(force, -1, 1))
        return np.asarray(np.tensordot(self._weight, np.moveaxis(seen, 1, -1), 1))

    def by_viscosities(self, fitted: Floats) -> Floats:
        """Compute the derivatives of the places by the logarithm of each film's own viscosity.

        Args:
            fitted: Fitted numbers (...), the own ones first [-].

        Returns:
            Derivatives (S, m, n) [m]; NaN where a film is too thin.
        """
        found, count = self._films.sensitivity(fitted), self._lines.by_position.shape[1]
        if found is None:
            return np.full((len(self._weight), len(self._lines.by_position), count), np.nan)
        which = slice(PARAMETERS.index("viscosity"), len(PARAMETERS) * count, len(PARAMETERS))
        seen = self._lines.seen(found.position[:, which], found.force[:, which])
        return np.asarray(np.tensordot(self._weight, np.moveaxis(seen, 1, -1), 1))


def _positions(found: Sequence[FilmEquilibrium]) -> Floats:
    return np.stack([one.position for one in found])
