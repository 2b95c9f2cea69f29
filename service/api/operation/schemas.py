"""Models of the service itself: its health, its sources and its quarantine."""

from datetime import datetime

from pydantic import BaseModel, Field


class SourceOut(BaseModel):
    """Reception progress of one start of a source."""

    machine: str
    source: str
    epoch: int
    next_sequence: int
    received: int
    duplicates: int
    lost: int
    late: int = Field(description="older than what run collection had seen when they were stored; they reopen runs")
    newest_sample_at: datetime | None = Field(description="when it was measured, by the source's clock")
    newest_received_at: datetime | None = Field(description="when it came, by the service's clock")


class QuarantineEntry(BaseModel):
    """A rejected message or sample."""

    id: int
    received_at: datetime
    key: str
    machine: str | None
    reason: str
    meaning: str = Field(description="the reason in a person's words, and what to do")
    detail: str
    size: int
    payload: str = Field(description="its beginning, with what is not text escaped")


class Quarantine(BaseModel):
    """Rejected input: total counts, and the newest entries."""

    counts: dict[str, int]
    entries: list[QuarantineEntry]


class Purged(BaseModel):
    """Number of quarantine entries that were deleted."""

    deleted: int


class Life(BaseModel):
    """Liveness: whether the process can still do its work."""

    alive: bool


class Health(BaseModel):
    """Health of each part of the service, with the fault where it does not work."""

    healthy: bool
    version: str
    ready: bool
    parts: dict[str, str] = Field(description="`ok`, or what is wrong, per part")
    database: str = Field(description="product and version that keep the data")
    warnings: list[str] = Field(description="what does not hinder the service yet and should be seen to")
    jobs: dict[str, int] = Field(description="identification jobs by state")
