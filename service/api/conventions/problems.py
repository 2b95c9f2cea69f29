"""The problems that operations declare for the OpenAPI document, and an error for input that nothing can be made of."""

from http import HTTPStatus
from typing import Any

from estimator.errors import Invalid
from service.http.problem import Problem


class Unsuitable(Invalid):
    """What is asked for cannot be made from what is given, and why."""


RESPONSES: dict[int | str, dict[str, Any]] = {
    code: {"model": Problem, "content": {"application/problem+json": {}}, "description": HTTPStatus(code).phrase}
    for code in (404, 422)
}
"""For the OpenAPI document of routers."""

CHANGES: dict[int | str, dict[str, Any]] = {
    409: {"model": Problem, "content": {"application/problem+json": {}}, "description": HTTPStatus.CONFLICT.phrase}
}
"""The same for operations that what is there may forbid."""

WAIT: dict[int | str, dict[str, Any]] = {
    429: {
        "model": Problem,
        "content": {"application/problem+json": {}},
        "description": "as many identifications wait as may",
        "headers": {"Retry-After": {"description": "when to ask again [s]", "schema": {"type": "integer"}}},
    }
}
"""The same for operations that ask for identifications."""
