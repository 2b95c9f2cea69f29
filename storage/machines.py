"""Repository of machines and the revisions of their documents."""

from collections.abc import Collection, Sequence

from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from estimator.machine import Machine, parse_machine
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables import MachineRow, RevisionRow


class MachineExists(ValueError):
    """A machine of that id is there already."""


class MachineUnknown(KeyError):
    """No machine of that id."""


class RevisionUnknown(MachineUnknown):
    """The machine is there, but no such revision of its document."""


class PlantChanged(ValueError):
    """A revision may not move a machine to another plant: its key on the wire would change."""


def create(session: Session, machine: Machine) -> RevisionRow:
    """Store a new machine as revision 1. Raises MachineExists."""
    if session.get(MachineRow, machine.id) is not None:
        raise MachineExists(f"machine '{machine.id}' exists already; revise it instead")
    session.add(MachineRow(id=machine.id, plant=machine.plant, revision=1, created_at=now()))
    try:
        session.flush()
    except IntegrityError as error:  # one that this session does not see
        raise MachineExists(f"the id '{machine.id}' is taken: choose another") from error
    return _add_revision(session, machine, 1)


def revise(session: Session, machine: Machine) -> RevisionRow:
    """Store a new revision of a machine; a document equal to the one in force changes nothing.

    Raises MachineUnknown, PlantChanged.
    """
    row = get(session, machine.id)
    if row.plant != machine.plant:
        raise PlantChanged(f"machine '{machine.id}' belongs to plant '{row.plant}', not '{machine.plant}'")
    current = revision(session, machine.id, row.revision)
    if parse_machine(current.document) == machine:
        return current
    row.revision += 1
    return _add_revision(session, machine, row.revision)


def get(session: Session, machine_id: str) -> MachineRow:
    """Raises MachineUnknown."""
    row = session.get(MachineRow, machine_id)
    if row is None:
        raise MachineUnknown(machine_id)
    return row


def some(session: Session, machine_ids: Collection[str]) -> Sequence[MachineRow]:
    """Those of these machines that are known."""
    return session.scalars(select(MachineRow).where(MachineRow.id.in_(machine_ids))).all()


def every(session: Session) -> Sequence[MachineRow]:
    """All machines, by id."""
    return session.scalars(select(MachineRow).order_by(MachineRow.id)).all()


def ids(session: Session) -> Sequence[str]:
    """Ids of all machines, in order."""
    return session.scalars(select(MachineRow.id).order_by(MachineRow.id)).all()


def lock(session: Session, machine_id: str) -> None:
    """Keep other transactions that ask for this from concluding anything about the machine until this one ends."""
    session.execute(select(MachineRow.id).where(MachineRow.id == machine_id).with_for_update())


def revision(session: Session, machine_id: str, number: int) -> RevisionRow:
    """Raises MachineUnknown, of a machine that is there RevisionUnknown."""
    row = session.get(RevisionRow, (machine_id, number))
    if row is None:
        raise RevisionUnknown(f"{number} of machine '{get(session, machine_id).id}'")
    return row


def revisions(
    session: Session, machine_id: str, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[RevisionRow]:
    """All revisions of a machine, oldest first; after: the one before."""
    query = select(RevisionRow).where(RevisionRow.machine_id == machine_id)
    return session.scalars(ordered(query, (RevisionRow.revision,), after, descending=False).limit(limit)).all()


def document(session: Session, machine_id: str, number: int | None = None) -> Machine:
    """The machine's document, by default the revision in force. Raises MachineUnknown."""
    number = get(session, machine_id).revision if number is None else number
    return parse_machine(revision(session, machine_id, number).document)


def comparable(session: Session, machine_id: str, number: int) -> list[int]:
    """Revisions without a break around a given one under which identifications can be compared with its own, ascending."""
    rows = revisions(session, machine_id)
    documents = {row.revision: parse_machine(row.document) for row in rows}
    own = documents[number]
    found = [number]
    for step in (-1, 1):
        other = number + step
        while other in documents and documents[other].describes_the_same_as(own):
            found.append(other)
            other += step
    return sorted(found)


def measured_alike(session: Session, machine_id: str, number: int) -> list[int]:
    """Those of them whose samples have the same channels and operating conditions, in the same order, ascending."""
    rows = revisions(session, machine_id)
    names = {row.revision: parse_machine(row.document).condition_names for row in rows}
    return [one for one in comparable(session, machine_id, number) if names[one] == names[number]]


def _add_revision(session: Session, machine: Machine, number: int) -> RevisionRow:
    row = RevisionRow(machine_id=machine.id, revision=number, document=machine.model_dump(mode="json"), created_at=now())
    session.add(row)
    session.flush()
    return row
