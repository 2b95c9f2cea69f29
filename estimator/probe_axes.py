"""From probes at any angles to displacements along x and y: two or more probes of different angles at one station of a shaft.

A probe at an angle β from +x towards +y measures x cos β + y sin β. Two such equations determine x and y, more are solved by
least squares; one probe alone, or probes in one line, stay channels and tell nothing of the other axis.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine import Machine

SAME_STATION = 0.005
"""Probes of one pair sit side by side where they do not fit into one plane: up to so far apart [m] they are at one station."""
LARGEST_CONDITION = 10.0
"""Condition number above which angles are too much alike: two probes less than 11.4° apart, or that short of 180°."""


@dataclass(frozen=True)
class ProbeStation:
    """The k probes at one station of a shaft.

    station: of the first of them [m]. channels: their ids. columns: their places among the machine's channels. angle: (k,)
    from +x towards +y [rad].
    """

    shaft: str
    station: float
    channels: tuple[str, ...]
    columns: tuple[int, ...]
    angle: Floats

    @property
    def directions(self) -> Floats:
        """(k, 2) cosine and sine of each angle."""
        return np.stack([np.cos(self.angle), np.sin(self.angle)], axis=1)

    @property
    def condition(self) -> float:
        """Condition number of the angles: 1 at right angles, infinite where the probes see one line only."""
        return float(_condition(self.directions.T @ self.directions))

    @property
    def sees_both_axes(self) -> bool:
        """Whether x and y follow from these probes."""
        return self.condition <= LARGEST_CONDITION


@dataclass(frozen=True)
class AxisPhasors:
    """Displacements along x and y in S samples.

    x, y: (S,) phasors, NaN where the usable probes do not determine them. inverse: (S, 2, k) what makes them from the k
    probes' phasors, zero for unusable ones.
    """

    x: Complexes
    y: Complexes
    inverse: Floats

    @property
    def known(self) -> NDArray[np.bool_]:
        """(S,) where x and y are determined."""
        return np.isfinite(self.x)

    def pick(self, which: NDArray[np.bool_]) -> "AxisPhasors":
        """Some of the samples."""
        return AxisPhasors(self.x[which], self.y[which], self.inverse[which])


def probe_stations(machine: Machine) -> tuple[ProbeStation, ...]:
    """The stations at which a machine has probes, in the document's order."""
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
    """x and y from the phasors (S, m) of all the machine's channels, of which (S, m) some are usable."""
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
    """Condition number of the directions from their normal matrices (…, 2, 2)."""
    smallest, largest = np.moveaxis(np.linalg.eigvalsh(normal), -1, 0)
    alike = smallest <= 1e-12 * np.maximum(largest, 1e-300)
    return np.where(alike, np.inf, np.sqrt(np.divide(largest, smallest, out=np.ones_like(largest), where=~alike)))
