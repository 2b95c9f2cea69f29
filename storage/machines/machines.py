"""Repository of machines and the revisions of their documents."""

import json
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate

from sqlalchemy import ColumnElement, Text, cast, func, select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from estimator.errors import Conflict, Missing
from estimator.machine.document import Machine, parse_machine
from storage.clock import now
from storage.paging import Keys, ordered
from storage.tables.machines import MachineRow, RevisionRow

PARSED = 64
"""Number of parsed documents that are kept: parsing one takes 1 ms, for a long train 5."""


class MachineExists(Conflict):
    """A machine with this id exists already."""


class MachineUnknown(Missing):
    """Raised when no machine has this id."""

    subject = "machine"


class RevisionUnknown(MachineUnknown):
    """The machine exists, but not this revision of its document."""

    subject = "revision"


class PlantChanged(Conflict):
    """A revision must not move a machine to another plant: its key on the wire would change."""


def create(session: Session, machine: Machine) -> RevisionRow:
    """Store a new machine as revision 1. Raises MachineExists."""
    if session.get(MachineRow, machine.id) is not None:
        raise MachineExists(f"machine '{machine.id}' exists already; revise it instead")
    session.add(MachineRow(id=machine.id, plant=machine.plant, revision=1, created_at=now()))
    try:
        session.flush()
    except IntegrityError as error:  # one that this session does not see
        raise MachineExists(f"the id '{machine.id}' is taken: choose another") from error
    return _add_revision(session, machine, 1, None)


def revise(session: Session, machine: Machine) -> RevisionRow:
    """Store a new revision of a machine; a document equal to the one in force changes nothing.

    Raises MachineUnknown, PlantChanged.
    """
    row = get(session, machine.id)
    if row.plant != machine.plant:
        raise PlantChanged(f"machine '{machine.id}' belongs to plant '{row.plant}', not '{machine.plant}'")
    current = revision(session, machine.id, row.revision)
    before = parsed(current)
    if before == machine:
        return current
    row.revision += 1
    return _add_revision(session, machine, row.revision, (current, before))


def get(session: Session, machine_id: str) -> MachineRow:
    """Return a machine by id; raise MachineUnknown when there is none."""
    row = session.get(MachineRow, machine_id)
    if row is None:
        raise MachineUnknown(machine_id)
    return row


def by_ids(session: Session, machine_ids: Collection[str]) -> Sequence[MachineRow]:
    """Return those of these machines that are known."""
    return session.scalars(select(MachineRow).where(MachineRow.id.in_(machine_ids))).all()


def list_all(session: Session) -> Sequence[MachineRow]:
    """Return all machines, by id."""
    return session.scalars(select(MachineRow).order_by(MachineRow.id)).all()


def list_ids(session: Session) -> Sequence[str]:
    """Return the ids of all machines, in order."""
    return session.scalars(select(MachineRow.id).order_by(MachineRow.id)).all()


def lock(session: Session, machine_id: str) -> None:
    """Lock a machine until this transaction ends, against other transactions that draw conclusions about it."""
    session.execute(select(MachineRow.id).where(MachineRow.id == machine_id).with_for_update())


def revision(session: Session, machine_id: str, number: int) -> RevisionRow:
    """Return a revision of a machine. Raises MachineUnknown, for a known machine RevisionUnknown."""
    row = session.get(RevisionRow, (machine_id, number))
    if row is None:
        raise RevisionUnknown(f"{number} of machine '{get(session, machine_id).id}'")
    return row


def revisions(
    session: Session, machine_id: str, *, limit: int | None = None, after: Keys | None = None
) -> Sequence[RevisionRow]:
    """Return all revisions of a machine, oldest first. after: the last revision of the page before."""
    query = select(RevisionRow).where(RevisionRow.machine_id == machine_id)
    return session.scalars(ordered(query, (RevisionRow.revision,), after, descending=False).limit(limit)).all()


def count_within(session: Session, machine_id: str, *, limit: int, after: Keys | None, size: int) -> int:
    """Return how many of the revisions that `revisions` returns have documents of `size` [characters] in all; at least one."""
    length: ColumnElement[int] = func.length(cast(RevisionRow.document, Text))
    query = select(length).where(RevisionRow.machine_id == machine_id)
    lengths = session.scalars(ordered(query, (RevisionRow.revision,), after, descending=False).limit(limit)).all()
    return max(1, len([whole for whole in accumulate(lengths) if whole <= size]))


def document(session: Session, machine_id: str, number: int | None = None) -> Machine:
    """Return the machine's document, by default the revision in force. Raises MachineUnknown."""
    number = get(session, machine_id).revision if number is None else number
    return parsed(revision(session, machine_id, number))


def parsed(row: RevisionRow) -> Machine:
    """Return the document of a revision, the same object for equal ones: nothing changes a machine once it is parsed."""
    return _parsed(json.dumps(row.document))


@lru_cache(maxsize=PARSED)
def _parsed(text: str) -> Machine:
    return parse_machine(json.loads(text))


def comparable_revisions(session: Session, machine_id: str, number: int) -> list[int]:
    """Return the contiguous revisions around a given one whose identifications are comparable with its own, ascending.

    Raises MachineUnknown.
    """
    return revision_history(session, machine_id, number).comparable(number)


def revisions_with_same_channels(session: Session, machine_id: str, number: int) -> list[int]:
    """Return the comparable revisions whose samples have the same channels and operating conditions in the same order,
    ascending.

    Raises MachineUnknown.
    """
    spans = revision_history(session, machine_id, number).around(number)
    own = next(span.document.condition_names for span in spans if number in span.revisions)
    return [one for span in spans if span.document.condition_names == own for one in span.revisions]


@dataclass(frozen=True)
class RevisionSpan:
    """Contiguous revisions of the same train with the same operating conditions. document: that of the first of them."""

    revisions: range
    document: Machine


@dataclass(frozen=True)
class RevisionHistory:
    """All revisions of one train, in spans of the same operating conditions, ascending."""

    spans: Sequence[RevisionSpan]

    def comparable(self, number: int) -> list[int]:
        """Return the contiguous revisions around a given one whose identifications are comparable with its own, ascending;
        none for a revision of another train."""
        return [one for span in self.around(number) for one in span.revisions]

    def around(self, number: int) -> Sequence[RevisionSpan]:
        """Return the spans of the revisions that are comparable with a given one."""
        own = next((place for place, span in enumerate(self.spans) if number in span.revisions), None)
        if own is None:
            return ()
        documents = [span.document for span in self.spans]
        first = last = own
        while first > 0 and documents[first - 1].describes_the_same_as(documents[own]):
            first -= 1
        while last + 1 < len(documents) and documents[last + 1].describes_the_same_as(documents[own]):
            last += 1
        return self.spans[first : last + 1]


def revision_history(session: Session, machine_id: str, number: int) -> RevisionHistory:
    """Return the revisions of the train that a given one describes. Raises MachineUnknown.

    Only the first document of each span is read: their number is that of the changes of operating conditions, however many
    revisions there are.
    """
    same = revision(session, machine_id, number).same_since
    query = (
        select(RevisionRow.alike_since, func.max(RevisionRow.revision))
        .where(RevisionRow.machine_id == machine_id, RevisionRow.same_since == same)
        .group_by(RevisionRow.alike_since)
        .order_by(RevisionRow.alike_since)
    )
    ranges = [range(first, last + 1) for first, last in session.execute(query)]
    return RevisionHistory([RevisionSpan(one, document(session, machine_id, one.start)) for one in ranges])


def _add_revision(session: Session, machine: Machine, number: int, before: tuple[RevisionRow, Machine] | None) -> RevisionRow:
    """Store a revision. before: the revision in force until now, and its document."""
    same = alike = number
    if before is not None and machine.is_the_same_train_as(before[1]):
        same = before[0].same_since
        alike = before[0].alike_since if machine.conditions == before[1].conditions else number
    row = RevisionRow(
        machine_id=machine.id,
        revision=number,
        document=machine.model_dump(mode="json"),
        created_at=now(),
        same_since=same,
        alike_since=alike,
    )
    session.add(row)
    session.flush()
    return row
