"""Key of a source's samples."""

from msgspec import Struct


class SourceKey(Struct, frozen=True):
    """One start of one source of one machine."""

    machine_id: str
    source: str
    epoch: int
