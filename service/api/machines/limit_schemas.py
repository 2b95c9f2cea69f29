"""Models of limits."""

from datetime import datetime

from pydantic import BaseModel, ConfigDict

from service.api.conventions.fields import NonBlankText
from service.monitoring.rules.limits import Limits
from service.security.principal import Author


class LimitsIn(BaseModel):
    """Limits to put in force, with their author and the reason. Omitted limits take their defaults."""

    model_config = ConfigDict(extra="forbid")

    by: Author
    comment: NonBlankText
    limits: Limits


class LimitsOut(BaseModel):
    """One version of a machine's limits. Version 0 is the defaults, which nobody has set."""

    machine: str
    version: int
    limits: Limits
    set_at: datetime | None
    by: str | None
    comment: str | None
