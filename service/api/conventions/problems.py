"""Problem responses that operations declare for the OpenAPI document, and an error for unsuitable input."""

from http import HTTPStatus
from typing import Any

from estimator.errors import Invalid
from service.http.problem import Problem


class Unsuitable(Invalid):
    """The requested result cannot be made from the given input; the detail says why."""


RESPONSES: dict[int | str, dict[str, Any]] = {
    code: {"model": Problem, "content": {"application/problem+json": {}}, "description": HTTPStatus(code).phrase}
    for code in (404, 422)
}
"""Responses that routers declare: not found, invalid input."""

CHANGES: dict[int | str, dict[str, Any]] = {
    409: {"model": Problem, "content": {"application/problem+json": {}}, "description": HTTPStatus.CONFLICT.phrase}
}
"""Responses of operations that can conflict with the current state."""

WAIT: dict[int | str, dict[str, Any]] = {
    429: {
        "model": Problem,
        "content": {"application/problem+json": {}},
        "description": "as many identifications wait as may",
        "headers": {"Retry-After": {"description": "when to ask again [s]", "schema": {"type": "integer"}}},
    }
}
"""Responses of operations that ask for identifications."""
