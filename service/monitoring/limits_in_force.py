"""Reading and setting the limits of a machine."""

from sqlalchemy.orm import Session

from estimator.errors import Outdated
from service.monitoring.rules.limits import Limits, require_suited
from storage.machines import limits, machines
from storage.tables.machines import LimitsRow


class LimitsChanged(Outdated):
    """Somebody else has set other limits in the meantime."""


def limits_in_force(session: Session, machine_id: str) -> Limits:
    """Read a machine's limits; the defaults when nobody has set any."""
    return limits_of(limits.in_force(session, machine_id))


def limits_of(row: LimitsRow | None) -> Limits:
    """Parse the limits in a row; the defaults without a row."""
    return Limits() if row is None else Limits.model_validate(row.document)


def set_limits(
    session: Session, machine_id: str, wanted: Limits, *, by: str, comment: str, expected: int | None = None
) -> LimitsRow:
    """Put limits in force. expected: version that they replace, 0 for the defaults; None replaces any.

    Raises MachineUnknown, LimitsRefused when they do not suit the machine, LimitsChanged when another version is in force.
    """
    machine = machines.document(session, machine_id, machines.get(session, machine_id).revision)
    require_suited(wanted, machine)
    present = limits.in_force(session, machine_id)
    version = 0 if present is None else present.version
    if expected is not None and expected != version:
        raise LimitsChanged(f"version {version} of the limits is in force, not {expected}: read them, then change them")
    return limits.add(session, machine_id, document=wanted.model_dump(mode="json"), by=by, comment=comment)
