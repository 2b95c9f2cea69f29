"""A machine as OPC UA clients see it, read from the store."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from sqlalchemy.orm import Session

from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.parameter_names import (
    ALIGNMENT_UNITS,
    LOAD_UNITS,
    STATIC_LOAD_UNITS,
    derived_units,
    parameter_units,
)
from estimator.updated_model.vector_angle import angle_deg
from storage.findings import derived, identifications
from storage.machines import machines
from storage.machines.fleet import IdentificationGlance, MachineGlance
from storage.tables.findings import DerivedRow, EstimateRow, IdentificationRow

ACCEPTED = "accepted"
NOT_ACCEPTED = "not_accepted"
NOT_ESTIMABLE = "not_estimable"
NOT_IDENTIFIED = "not_identified"
"""No run has been identified since the machine has this parameter."""

PARAMETERS, ALIGNMENT, LOADS, DERIVED = "Parameters", "Alignment", "Loads", "Derived"
FOLDERS = (PARAMETERS, ALIGNMENT, LOADS, DERIVED)
"""Folders of a machine's values."""
LOAD_NAMES = (
    frozenset(STATIC_LOAD_UNITS)
    | frozenset(LOAD_UNITS)
    | {
        "misalignment_force",
        "misalignment_moment",
    }
)
UNBALANCE = "unbalance"
"""Quantity that is a vector whether or not it has a value."""


@dataclass(frozen=True)
class ValueReading:
    """The newest value of a parameter or derived quantity in SI units, with its 95 % interval.

    quality: one of those above. angle_deg: angle of an unbalance, whose value is the magnitude; None for anything else.
    reason: why there is no value, or why it is not to be trusted. measured_at: end of the run [ns].
    """

    folder: str
    name: str
    unit: str
    value: float | None
    lower: float | None
    upper: float | None
    angle_deg: float | None
    quality: str
    reason: str
    measured_at: int | None

    @property
    def has_angle(self) -> bool:
        """Return whether it is a vector, whose value is the magnitude."""
        return self.angle_deg is not None or describe(self.name).quantity == UNBALANCE


@dataclass(frozen=True)
class MachineReading:
    """A machine with the values of its newest identification of a single run, and that identification itself."""

    glance: MachineGlance
    identification: IdentificationGlance | None
    values: tuple[ValueReading, ...]

    @property
    def plant(self) -> str:
        """Return the plant that it belongs to."""
        return self.glance.machine.plant

    @property
    def id(self) -> str:
        """Return its id."""
        return self.glance.machine.id


def read_machine(session: Session, glance: MachineGlance) -> MachineReading:
    """Read a machine's newest values; those that its document names and no run has determined yet are there as well."""
    row = identifications.newest_of_single_run(session, glance.machine.id, accepted=False)
    newest, found = None, {}
    if row is not None:
        newest = IdentificationGlance(row.id, row.measured_at, row.accepted, row.verdict)
        estimates = identifications.estimates(session, row.id)
        quantities = derived.of_identification(session, row.id)
        found = {one.name: one for one in (*_of_estimates(row, estimates), *_of_derived(row, quantities))}
    document = machines.document(session, glance.machine.id)
    waiting = (one for one in _without_value(document, row) if one.name not in found)
    return MachineReading(glance, newest, (*found.values(), *waiting))


def _without_value(document: Machine, row: IdentificationRow | None) -> Iterator[ValueReading]:
    """Yield what a document names, parameters, alignment and loads, as far as the newest identification has it not."""
    why = "no run is identified yet" if row is None else "no run is identified yet since the machine has it"
    for name, unit in parameter_units(document).items():
        yield ValueReading(PARAMETERS, name, unit, None, None, None, None, NOT_IDENTIFIED, why, None)
    quality, at = NOT_IDENTIFIED, None
    if row is not None and not row.accepted:
        quality, why, at = NOT_ESTIMABLE, f"it follows from an accepted identification only: {row.verdict}", row.measured_at
    for name, unit in derived_units(document).items():
        if (folder := folder_of(name)) != DERIVED:
            yield ValueReading(folder, name, unit, None, None, None, None, quality, why, at)


def _of_estimates(row: IdentificationRow, estimates: Sequence[EstimateRow]) -> Iterator[ValueReading]:
    for one in estimates:
        vector = None if one.value is None or one.imaginary is None else complex(one.value, one.imaginary)
        yield ValueReading(
            folder=PARAMETERS,
            name=one.parameter,
            unit=one.unit,
            value=one.value if vector is None else abs(vector),
            lower=one.lower,
            upper=one.upper,
            angle_deg=None if vector is None else float(angle_deg(np.array([vector]))[0]),
            quality=_quality(row, one.value),
            reason=one.reason or ("" if row.accepted else row.verdict),
            measured_at=row.measured_at,
        )


def _of_derived(row: IdentificationRow, quantities: Sequence[DerivedRow]) -> Iterator[ValueReading]:
    for one in quantities:
        yield ValueReading(
            folder=folder_of(one.name),
            name=one.name,
            unit=one.unit,
            value=one.value,
            lower=one.lower,
            upper=one.upper,
            angle_deg=None,
            quality=_quality(row, one.value),
            reason=one.reason or ("" if row.accepted else row.verdict),
            measured_at=row.measured_at,
        )


def folder_of(name: str) -> str:
    """Return the folder of a derived quantity, such as Alignment of `coupling.C1.offset_vertical`."""
    quantity = describe(name).quantity
    if quantity in ALIGNMENT_UNITS:
        return ALIGNMENT
    return LOADS if quantity in LOAD_NAMES else DERIVED


def _quality(row: IdentificationRow, value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return NOT_ESTIMABLE
    return ACCEPTED if row.accepted else NOT_ACCEPTED
