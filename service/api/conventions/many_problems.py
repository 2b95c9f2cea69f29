"""Bodies with very many problems: only the first of each list are looked at, so that no request costs more than a few ms.

Of 4,000 wrong sections, 20 kB, pydantic and the framework would list 12,000 problems on the event loop, while nobody is
answered.
"""

from typing import Any

from fastapi.exceptions import RequestValidationError
from pydantic import ValidationError, ValidatorFunctionWrapHandler, WrapValidator

MOST_PROBLEMS = 200
"""Most problems of a request that an answer lists."""
MANY = 5 * MOST_PROBLEMS
"""Number of problems beyond which lists are shortened before they are listed."""
SHORTENED = 20
"""Number of objects of each list that are looked at then."""
DEPTH = 8
"""Depth down to which lists are looked for: more than any body has that is taken."""


def _few(value: Any, validated: ValidatorFunctionWrapHandler) -> Any:
    try:
        return validated(value)
    except ValidationError as error:
        if error.error_count() <= MANY:
            raise
        count = error.error_count()
    try:
        validated(_shortened(value))
    except ValidationError as error:
        found = [item | {"loc": ("body", *item["loc"])} for item in error.errors(include_url=False)]
    else:
        found = []
    words = f"{count} problems in all: those of the first {SHORTENED} of each list are told"
    raise RequestValidationError([*found, {"type": "too_many_problems", "loc": ("body",), "msg": words, "input": None}])


LISTING_FEW_PROBLEMS = WrapValidator(_few)
"""Annotation of a body that holds lists of objects."""


def _shortened(value: Any, depth: int = DEPTH) -> Any:
    """Return JSON whose lists of objects are cut; lists of numbers stay, whose lengths may have to agree."""
    if depth and isinstance(value, dict):
        return {name: _shortened(one, depth - 1) for name, one in value.items()}
    if depth and isinstance(value, list) and value and isinstance(value[0], dict):
        return [_shortened(one, depth - 1) for one in value[:SHORTENED]]
    return value
