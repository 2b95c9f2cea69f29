"""This process's share of the work, when several work on one database."""

import zlib
from collections.abc import Collection
from typing import Protocol

from sqlalchemy.orm import Session

SHARDS = 32
"""Number of parts into which the machines are divided for ingest; one replica at a time stores each."""
INGEST = tuple(f"machines-{number:02d}" for number in range(SHARDS))
DELIVERY, GATHERING, RETENTION = "delivery", "gathering", "retention"
"""Work that one replica does for all."""


def lease_of(machine_id: str) -> str:
    """Return the lease under which a machine's samples are stored."""
    return INGEST[zlib.crc32(machine_id.encode()) % SHARDS]


class Share(Protocol):
    """This process's share of the work. holder: its number among the replicas. changes: how often the share has changed."""

    @property
    def holder(self) -> int | None:
        """Return the number of this replica; None when it is the only one."""

    @property
    def changes(self) -> int:
        """Return how often the share has changed."""

    def is_owner(self, machine_id: str) -> bool:
        """Return whether this process stores a machine's samples, as far as it knows."""

    def is_leader(self, work: str) -> bool:
        """Return whether this process does this work for all, as far as it knows."""

    def require(self, session: Session, machine_ids: Collection[str]) -> None:
        """Raise LeaseLost unless these machines are this process's until the transaction ends."""


class WholeShare:
    """The whole work: the share of a process that is alone on its database."""

    holder: int | None = None
    changes = 0

    def is_owner(self, machine_id: str) -> bool:  # noqa: ARG002
        """Return True: it stores all machines."""
        return True

    def is_leader(self, work: str) -> bool:  # noqa: ARG002
        """Return True: it does all work."""
        return True

    def require(self, session: Session, machine_ids: Collection[str]) -> None:
        """Do nothing: there is no other process."""
