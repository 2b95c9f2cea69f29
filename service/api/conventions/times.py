"""Times as the API takes them: RFC 3339 texts. Plain numbers are rejected, because their epoch is unknown."""

import re
from datetime import datetime
from typing import Annotated

from pydantic import BeforeValidator

_BEGINNING = re.compile(r"\d{4}-\d{2}-\d{2}[Tt ]\d{2}:\d{2}")

_BLANK_FOR_PLUS = re.compile(r" \d{2}:\d{2}$")


def _written(value: object) -> object:
    if isinstance(value, str) and not _BEGINNING.match(value):
        raise ValueError("a time is written as in 2026-11-21T12:00:00Z")
    if isinstance(value, str) and _BLANK_FOR_PLUS.search(value):
        raise ValueError("in an address the + before the zone is written %2B; or give the time in UTC, with a Z at its end")
    if isinstance(value, int | float):
        raise ValueError("a time is a text, as in 2026-11-21T12:00:00Z")
    return value


Time = Annotated[datetime, BeforeValidator(_written)]
"""A time of a query; without a zone it counts as UTC unless its field requires one."""
