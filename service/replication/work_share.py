"""The share of the work that this process does, where several work on one database."""

import zlib
from collections.abc import Collection
from typing import Protocol

from sqlalchemy.orm import Session

SHARDS = 32
"""Parts into which the machines fall for ingest: each part is one replica's at a time."""
INGEST = tuple(f"machines-{number:02d}" for number in range(SHARDS))
DELIVERY, GATHERING, RETENTION = "delivery", "gathering", "retention"
"""Work that one replica does for all."""


def lease_of(machine_id: str) -> str:
    """Return the lease that a machine's samples are stored under."""
    return INGEST[zlib.crc32(machine_id.encode()) % SHARDS]


class Share(Protocol):
    """What is this process's to do. holder: its number among the replicas. changes: counts how often that changed."""

    @property
    def holder(self) -> int | None:
        """Return the number of this replica; None where it is the only one."""

    @property
    def changes(self) -> int:
        """Tell how often what is its to do has changed."""

    def owns(self, machine_id: str) -> bool:
        """Tell whether it stores a machine's samples, as far as it knows."""

    def leads(self, work: str) -> bool:
        """Tell whether it does this work for all, as far as it knows."""

    def require(self, session: Session, machine_ids: Collection[str]) -> None:
        """Raise LeaseLost unless these machines are its own until the transaction ends."""


class WholeShare:
    """All of it: the share of a process that is alone on its database."""

    holder: int | None = None
    changes = 0

    def owns(self, machine_id: str) -> bool:  # noqa: ARG002
        """Always."""
        return True

    def leads(self, work: str) -> bool:  # noqa: ARG002
        """Always."""
        return True

    def require(self, session: Session, machine_ids: Collection[str]) -> None:
        """Require nothing: nobody else is there."""
