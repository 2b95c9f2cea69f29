"""The problem detail (RFC 9457): the one shape of all errors over HTTP."""

from collections.abc import Mapping
from http import HTTPStatus

from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field


class FieldProblem(BaseModel):
    """A fault of one field."""

    field: str
    message: str


class Problem(BaseModel):
    """A problem detail."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldProblem] = Field(default_factory=list)


def problem_response(
    status: int, detail: str, headers: Mapping[str, str] | None = None, errors: list[FieldProblem] | None = None
) -> JSONResponse:
    """Return a problem detail as an answer."""
    problem = Problem(title=HTTPStatus(status).phrase, status=status, detail=detail, errors=errors or [])
    return JSONResponse(problem.model_dump(), status, dict(headers or {}), media_type="application/problem+json")
