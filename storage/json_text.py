"""JSON as it is stored: PostgreSQL takes no NaN and no infinity, so there is null in their place, in every database."""

import json
import math
from typing import Any


def written(value: Any) -> str:
    """The text of a value."""
    try:
        return json.dumps(value, allow_nan=False)
    except ValueError:
        return json.dumps(finite(value), allow_nan=False)


def finite(value: Any) -> Any:
    """The same with null wherever a number is none."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [finite(one) for one in value]
    return value
