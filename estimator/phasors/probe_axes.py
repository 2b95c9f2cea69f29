"""From probes at any angles to displacements along x and y: two or more probes of different angles at one station of a shaft.

A probe at an angle β from +x towards +y measures x cos β + y sin β. Two such equations determine x and y, more are solved by
least squares; one probe alone, or probes in one line, stay channels and tell nothing of the other axis.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine

SAME_STATION = 0.005
"""Largest distance of probes at one station [m]: those of a pair sit side by side where they do not fit into one plane."""
LARGEST_CONDITION = 10.0
"""Condition number above which angles are too much alike [-]: two probes less than 11.4° apart, or that short of 180°."""


class ProbeStation(Struct, frozen=True, eq=False):
    """The k probes at one station of a shaft.

    Attributes:
        shaft: Id of the shaft.
        station: Station of the first of them [m].
        channels: Ids of the probes.
        columns: Their indices among the machine's channels.
        angle: Angles (k,) from +x towards +y [rad].
    """

    shaft: str
    station: float
    channels: tuple[str, ...]
    columns: tuple[int, ...]
    angle: Floats

    @property
    def directions(self) -> Floats:
        """Return cosine and sine of each angle (k, 2) [-]."""
        return np.stack([np.cos(self.angle), np.sin(self.angle)], axis=1)

    @property
    def condition(self) -> float:
        """Return the condition number of the angles [-]: 1 at right angles, infinite where the probes see one line only.

        Source: standard result: condition number of the normal equations of x cos β + y sin β.
        """
        return float(_condition(self.directions.T @ self.directions))

    @property
    def sees_both_axes(self) -> bool:
        """Return whether x and y follow from these probes."""
        return self.condition <= LARGEST_CONDITION


class AxisPhasors(Struct, frozen=True, eq=False):
    """Displacements along x and y in S samples.

    Attributes:
        x: Phasors (S,) along x [m]; NaN where the usable probes do not determine them.
        y: Phasors (S,) along y [m]; NaN likewise.
        inverse: Matrices (S, 2, k) that make x and y from the k probes' phasors, zero for unusable ones [-].
    """

    x: Complexes
    y: Complexes
    inverse: Floats

    @property
    def known(self) -> NDArray[np.bool_]:
        """Return in which samples x and y are determined (S,)."""
        return np.isfinite(self.x)

    def pick(self, which: NDArray[np.bool_]) -> "AxisPhasors":
        """Return some of the samples.

        Args:
            which: True for the samples wanted (S,).

        Returns:
            Displacements in these samples.
        """
        return AxisPhasors(self.x[which], self.y[which], self.inverse[which])


def probe_stations(machine: Machine) -> tuple[ProbeStation, ...]:
    """List the stations at which a machine has probes.

    Args:
        machine: The machine.

    Returns:
        Stations in the document's order.
    """
    groups: list[list[int]] = []
    for column, probe in enumerate(machine.probes):
        for group in groups:
            first = machine.probes[group[0]]
            if first.shaft == probe.shaft and abs(first.station - probe.station) <= SAME_STATION:
                group.append(column)
                break
        else:
            groups.append([column])
    return tuple(
        ProbeStation(
            shaft=machine.probes[group[0]].shaft,
            station=machine.probes[group[0]].station,
            channels=tuple(machine.probes[column].id for column in group),
            columns=tuple(group),
            angle=np.deg2rad([machine.probes[column].angle_deg for column in group]),
        )
        for group in groups
    )


def axis_phasors(station: ProbeStation, *, phasor: Complexes, usable: NDArray[np.bool_]) -> AxisPhasors:
    """Solve for the displacements along x and y at one station, by least squares.

    Source: standard result: least squares of x cos β + y sin β.

    Args:
        station: The station.
        phasor: Phasors (S, m) of all the machine's channels [m].
        usable: True where a phasor may be used (S, m).

    Returns:
        Displacements in S samples [m].
    """
    columns = list(station.columns)
    counted = usable[:, columns]
    directions = station.directions
    normal = np.einsum("sk,ka,kb->sab", counted.astype(float), directions, directions)
    known = _condition(normal) <= LARGEST_CONDITION
    inverse = np.full((len(phasor), 2, len(columns)), np.nan)
    inverse[known] = np.linalg.solve(normal[known], np.where(counted[known, None, :], directions.T, 0.0))
    seen = np.where(counted, phasor[:, columns], 0.0)
    x, y = np.einsum("sak,sk->as", inverse, seen)
    return AxisPhasors(x, y, inverse)


def _condition(normal: Floats) -> Floats:
    """Compute the condition number of the directions from their normal matrices (..., 2, 2)."""
    smallest, largest = np.moveaxis(np.linalg.eigvalsh(normal), -1, 0)
    alike = smallest <= 1e-12 * np.maximum(largest, 1e-300)
    return np.where(alike, np.inf, np.sqrt(np.divide(largest, smallest, out=np.ones_like(largest), where=~alike)))
