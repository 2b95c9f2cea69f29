"""Models of the entries on a machine's timeline and of its baselines."""

from datetime import datetime
from typing import Annotated, Literal

from pydantic import BaseModel, Field

from estimator.strict_model import StrictModel
from service.api.conventions.fields import Moment, NonBlankText
from service.security.principal import Author


class TimelineIn(StrictModel):
    """A note or a marker. A maintenance begins a new baseline."""

    at: Moment
    kind: Literal["note", "maintenance", "marker"] = "note"
    text: NonBlankText
    by: Author


class TimelineOut(BaseModel):
    """An entry on a machine's timeline."""

    id: int
    machine: str
    at: datetime
    kind: str
    text: str
    by: str
    created_at: datetime


class BaselineIn(StrictModel):
    """A new baseline. Without named identifications it consists of the first accepted ones of each kind of run."""

    since: Moment
    reason: NonBlankText
    by: Author
    identifications: Annotated[list[Annotated[int, Field(ge=0, le=2**62)]], Field(max_length=200)] | None = None


class BaselineOut(BaseModel):
    """A baseline and the moment from which it is in force."""

    id: int
    machine: str
    since: datetime
    identifications: list[int] | None
    reason: str
    by: str
    created_at: datetime
