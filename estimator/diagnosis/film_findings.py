"""Changes that can happen to a train on oil films, in its own numbers: alignment, settlement, wear, oil, process forces.

A misaligned coupling has everything behind it moved as one rigid body: by an offset at the coupling, and by an angle about it
(Piotrowski, Shaft Alignment Handbook, CRC Press, 3rd ed. 2006). A shaft on two bearings stays straight when one of them
settles, so that this is a mix of offset and angle at its couplings: only on trains with more bearings, or between two
couplings, is a settled bearing something of its own.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from estimator.arrays import Floats
from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.finding_kind import BaselineValues, Cause, ChangeSize, ExpectedChange, SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.coupling_neighbours import shafts_behind
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.machine.parts import Coupling
from estimator.machine.train_layout import shaft_begins

OFFSET, ANGLE = 100e-6, 100e-6
"""Expected change of an offset [m] and of an angle [rad] of a coupling, in either plane."""
SMALL = 0.25
"""Size of small changes that are looked for beside those expected, as a part of these [-]."""
SETTLEMENT = 50e-6
"""Expected change of a bearing's elevation, in either plane, and what is counted as allowed of it [m]."""
DEVIATION = 2.0
"""Expected change of a film's deviations, in units of what the document allows for [-]."""
WEAR = 0.15
"""Expected change of the logarithm of a clearance [-]."""
OIL = 0.7
"""Expected change of the logarithm of all viscosities, such as one and a half grades of ISO VG [-]."""
PLANES = ("elevation_y", "elevation_x")
"""Elevations in the vertical and in the horizontal plane."""
LEAST_FORCE = 100.0
"""Least static force that a change is compared with [N]: of one that is hardly there nothing is large in per cent."""
INDEPENDENT = 1e-6
"""Part of a unit change that must be left beside others to be one of its own [-]."""


def knows_films(columns: ChangeColumns) -> bool:
    """Return whether the quantities of a diagnosis are those of a train on oil films.

    Args:
        columns: The columns.

    Returns:
        Whether they are.
    """
    return f"bearing.{columns.machine.bearings[0].id}.{PLANES[0]}" in columns.names


def moved_alignments(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield what a change of offset and angle of each coupling moves: all bearings behind it (Piotrowski 2006).

    Args:
        columns: The columns.

    Yields:
        The change at each coupling.
    """
    if not knows_films(columns):
        return
    for coupling in columns.machine.couplings:
        offset, angle = rigid_motion(columns.machine, coupling)
        planes = [
            np.column_stack([OFFSET * _raised(columns, plane, offset), ANGLE * _raised(columns, plane, angle)])
            for plane in PLANES
        ]
        whole = np.column_stack(planes)
        shafts = (coupling.driver, coupling.driven)
        beside = [f"bearing.{one.id}" for one in columns.machine.bearings if one.shaft in shafts]  # whose loads follow
        elements = frozenset([f"coupling.{coupling.id}", *beside])
        yield ExpectedChange(f"coupling.{coupling.id}", (whole, SMALL * whole, *planes), elements)


def settlements(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of the elevation of each bearing that is no change of one coupling's alignment.

    Source: lever rule, Piotrowski, Shaft Alignment Handbook, CRC Press, 3rd ed. 2006.

    Args:
        columns: The columns.

    Yields:
        The change at each such bearing.
    """
    if not knows_films(columns):
        return
    machine = columns.machine
    for number, bearing in enumerate(machine.bearings):
        lifted = np.eye(len(machine.bearings))[number]
        if all(_lies_beside(machine, coupling, lifted) for coupling in machine.couplings):
            whole = np.column_stack([SETTLEMENT * _raised(columns, plane, lifted) for plane in PLANES])
            yield ExpectedChange(f"bearing.{bearing.id}", (whole,))


def film_changes(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of each bearing's film that is neither wear nor oil nor load: that of its deviations from its model.

    Args:
        columns: The columns.

    Yields:
        The change at each bearing.
    """
    for bearing in columns.machine.bearings:
        own = [describe(name).element == f"films.{bearing.id}" for name in columns.names]
        if any(own):
            each = DEVIATION * np.eye(len(columns.names))[:, own]
            yield ExpectedChange(f"bearing.{bearing.id}", (each,), frozenset([f"bearing.{bearing.id}"]))


def wears(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of the clearance of each bearing on a film, upwards.

    Args:
        columns: The columns.

    Yields:
        The change at each bearing.
    """
    if not knows_films(columns):
        return
    for bearing in columns.machine.bearings:
        grown = np.array([float(name == f"bearing.{bearing.id}.clearance") for name in columns.names])
        if not grown.any():
            continue  # it is no film
        yield ExpectedChange(f"bearing.{bearing.id}", (WEAR * grown[:, None],), rising=grown[None, :])


def oils(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the common change of all viscosities, and that of each supply's, beyond what seasons do.

    Args:
        columns: The columns.

    Yields:
        The change of the machine's oil.
    """
    if not knows_films(columns):
        return
    supplies = [
        name.partition(".viscosity")[0] if describe(name).quantity == "viscosity_factor" else "own"
        for name in columns.names
        if describe(name).quantity in ("viscosity", "viscosity_factor")
    ]
    every = [float(describe(name).quantity in ("viscosity", "viscosity_factor")) for name in columns.names]
    single = [
        OIL * np.array([float(name == f"{supply}.viscosity_factor") for name in columns.names])[:, None]
        for supply in dict.fromkeys(supplies)
        if supply != "own" and len(set(supplies)) > 1
    ]
    yield ExpectedChange("machine", (OIL * np.array(every)[:, None], *single))


def process_forces(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    """Yield the change of each static force that the document leaves to be identified, by as much as it says it may be off.

    Args:
        columns: The columns.

    Yields:
        The change of each such force.
    """
    for load in columns.machine.static_loads:
        spreads = {f"static_load.{load.id}.force_{axis}": getattr(load, f"force_{axis}_spread") for axis in ("x", "y")}
        each = [spreads.get(name, 0.0) * np.eye(len(columns.names))[place] for place, name in enumerate(columns.names)]
        moved = [column for column in each if column.any()]
        if moved:
            whole = np.column_stack(moved)
            yield ExpectedChange(f"static_load.{load.id}", (whole, SMALL * whole))


def rigid_motion(machine: Machine, coupling: Coupling) -> tuple[Floats, Floats]:
    """Return the elevations of all n bearings when what lies behind a coupling is raised, and turned about it, as one body.

    Args:
        machine: The machine.
        coupling: One of its couplings.

    Returns:
        Elevations per unit of its offset (n,) [m/m] and of its angle (n,) [m/rad].
    """
    begins = shaft_begins(machine)
    behind = shafts_behind(machine, coupling)
    offset = np.array([float(one.shaft in behind) for one in machine.bearings])
    away = np.array([begins[one.shaft] + one.station - begins[coupling.driven] for one in machine.bearings])
    return offset, np.asarray(offset * away)


def wear_size(cause: Cause, baseline: BaselineValues) -> ChangeSize:
    """Return the growth of a clearance, in per cent and in µm.

    Args:
        cause: The wear.
        baseline: Values in the baseline.

    Returns:
        The size.
    """
    (name,) = cause.names
    growth, error = math.expm1(float(cause.change[0])), float(cause.error[0])
    before = math.exp(baseline.quantities[name])
    quantities = {
        "clearance_per_cent": 100.0 * growth,
        "clearance_error_per_cent": 100.0 * error,
        "before_um": 1e6 * before,
        "after_um": 1e6 * before * (1.0 + growth),
    }
    return ChangeSize(100.0 * growth, quantities, parts=(_grown(name, float(cause.change[0]), error),))


def film_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return the root mean square of the change of a film's deviations, in units of what the document allows for.

    Args:
        cause: The change of the film.

    Returns:
        The size.
    """
    times = float(np.sqrt(np.mean(cause.change**2)))
    slope = cause.change / (cause.change.size * max(times, 1e-300))
    half = CONFIDENCE_95 * math.sqrt(max(0.0, float(slope @ cause.covariance @ slope)))
    part = SizePart(f"{cause.element}.film_deviation", "times", times, max(0.0, times - half), times + half, allowed=1.0)
    return ChangeSize(None, {"deviation_times_allowed": times}, tolerance_per_cent=100.0 * times, parts=(part,))


def oil_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return the change of the viscosities that have changed.

    Args:
        cause: The oil.

    Returns:
        The size.
    """
    mean = float(np.mean(cause.change))
    growth = 100.0 * math.expm1(mean)
    error = math.sqrt(max(0.0, float(np.mean(cause.covariance))))
    part = replace(_grown("machine.viscosity", mean, error), members=cause.names)
    return ChangeSize(growth, {"viscosity_per_cent": growth}, parts=(part,))


def settlement_size(cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    """Return by how much a bearing has risen, and moved sideways.

    Args:
        cause: The settlement.

    Returns:
        The size.
    """
    words = {"elevation_y": "vertical", "elevation_x": "horizontal"}
    quantities: dict[str, float] = {}
    parts: list[SizePart] = []
    for name, change, error in zip(cause.names, cause.change, cause.error, strict=True):
        plane = words[describe(name).quantity]
        rise, uncertain = 1e6 * float(change), 1e6 * float(error)
        quantities |= {f"{plane}_um": rise, f"{plane}_error_um": uncertain}
        half = CONFIDENCE_95 * uncertain
        parts.append(SizePart(f"{cause.element}.{plane}", "um", rise, rise - half, rise + half, rise / max(uncertain, 1e-12)))
    parts.sort(key=lambda one: -abs(one.value))
    largest = float(np.max(np.abs(cause.change)))
    return ChangeSize(None, quantities, tolerance_per_cent=100.0 * largest / SETTLEMENT, parts=tuple(parts))


def process_force_size(cause: Cause, baseline: BaselineValues) -> ChangeSize:
    """Return by how much a static force has changed, in N and over what was found of it in the baseline.

    Source: standard result: norm of the change over that of the force before.

    Args:
        cause: The change of the force.
        baseline: Values in the baseline.

    Returns:
        The size.
    """
    before = [baseline.quantities[name] for name in cause.names]
    quantities: dict[str, float] = {}
    parts: list[SizePart] = []
    for name, change, error, was in zip(cause.names, cause.change.tolist(), cause.error.tolist(), before, strict=True):
        axis = describe(name).quantity
        quantities |= {f"{axis}_n": change, f"{axis}_error_n": error, f"{axis}_before_n": was}
        half = CONFIDENCE_95 * error
        parts.append(SizePart(name, "N", change, change - half, change + half, change / max(error, 1e-12)))
    parts.sort(key=lambda one: -abs(one.value))
    whole = max(float(np.linalg.norm(before)), LEAST_FORCE)
    return ChangeSize(100.0 * float(np.linalg.norm(cause.change)) / whole, quantities, parts=tuple(parts))


def _grown(name: str, change: float, error: float) -> SizePart:
    """Return the growth of a quantity by the change of its logarithm [%]."""
    low, high = (100.0 * math.expm1(change + sign * CONFIDENCE_95 * error) for sign in (-1.0, 1.0))
    return SizePart(name, "%", 100.0 * math.expm1(change), low, high, change / max(error, 1e-12))


def _raised(columns: ChangeColumns, plane: str, elevations: Floats) -> Floats:
    """Return the column (N,) of elevations of all bearings in one plane."""
    found = np.zeros(len(columns.names))
    for bearing, elevation in zip(columns.machine.bearings, elevations, strict=True):
        found[columns.names.index(f"bearing.{bearing.id}.{plane}")] = elevation
    return found


def _lies_beside(machine: Machine, coupling: Coupling, lifted: Floats) -> bool:
    """Check that elevations are neither a change of a coupling's alignment nor a motion of the whole train."""
    begins = shaft_begins(machine)
    place = np.array([begins[one.shaft] + one.station for one in machine.bearings])
    rigid = np.column_stack([*rigid_motion(machine, coupling), np.ones(len(place)), place])
    left = lifted - rigid @ np.linalg.lstsq(rigid, lifted, rcond=None)[0]
    return bool(np.linalg.norm(left) > INDEPENDENT)
