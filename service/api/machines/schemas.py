"""Models of machines and of the revisions of their documents."""

from datetime import datetime

from pydantic import BaseModel, Field

from estimator.machine.document import Machine


class MachineSummary(BaseModel):
    """A machine in a list."""

    id: str
    plant: str
    name: str
    revision: int
    created_at: datetime


class MachineRevision(BaseModel):
    """A machine's document at one revision."""

    id: str
    revision: int
    created_at: datetime
    document: Machine
    warnings: list[str] = Field(
        description="what is probably a mistake in the document, each with its field, and what is usual"
    )
