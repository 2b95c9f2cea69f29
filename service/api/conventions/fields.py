"""Types of fields that several resources have: names, comments, moments."""

from datetime import UTC, datetime
from typing import Annotated

from pydantic import AfterValidator, Field

from service.api.conventions.times import Time

DisplayName = Annotated[str, Field(min_length=1, max_length=120, pattern=r"^[^\x00-\x1f]*$")]

Comment = Annotated[str, Field(max_length=2000, pattern=r"^[^\x00]*$")]

NonBlankText = Annotated[str, Field(min_length=1, max_length=2000, pattern=r"^[^\x00]*[^\x00\s][^\x00]*$")]
"""A comment that is not blank."""

EARLIEST, LATEST = datetime(1970, 1, 1, tzinfo=UTC), datetime(2262, 1, 1, tzinfo=UTC)
"""Range of moments that the store accepts."""


def _aware(moment: datetime) -> datetime:
    if moment.tzinfo is None:
        raise ValueError("a moment needs its zone, such as 2026-11-21T12:00:00Z")
    if not EARLIEST <= moment <= LATEST:
        raise ValueError(f"a moment lies between {EARLIEST:%Y} and {LATEST:%Y}")
    return moment


Moment = Annotated[Time, AfterValidator(_aware)]
