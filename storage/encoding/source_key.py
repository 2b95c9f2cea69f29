"""Key of a source's samples."""

from dataclasses import dataclass


@dataclass(frozen=True)
class SourceKey:
    """One start of one source of one machine."""

    machine_id: str
    source: str
    epoch: int
