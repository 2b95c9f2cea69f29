"""Answers every error with a problem detail (RFC 9457)."""

import asyncio
import re
from collections.abc import Iterable, Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel
from sqlalchemy.exc import DBAPIError
from starlette.exceptions import HTTPException as StarletteHTTPException

from estimator.errors import Damaged, DomainError, Missing
from estimator.machine.document import problems_of
from estimator.strict_model import own_words
from service.api.conventions.dependencies import database, principal
from service.api.conventions.many_problems import MOST_PROBLEMS
from service.api.conventions.patterns import WORDS
from service.http.database_errors import categorized
from service.http.error_status import status_of
from service.http.problem import FieldProblem, problem_response
from service.http.security_headers import ALWAYS
from service.security.scope import machines_like

UNREADABLE = "There was an error parsing the body"
"""Detail that the framework gives for a body that is not JSON."""


def add_handlers(app: FastAPI, listed: Mapping[str, str]) -> None:
    """Register handlers that answer every error with a problem detail. listed: hints by the subject of what is missing.

    Raises LookupError when an error of missing objects has no subject, or its subject no hint.
    """
    require_every_hint(listed)
    app.state.listed = listed
    app.exception_handler(DomainError)(_domain_error)
    app.exception_handler(RequestValidationError)(_wrong_request)
    app.exception_handler(StarletteHTTPException)(_http_error)
    app.exception_handler(DBAPIError)(_database_error)
    app.exception_handler(Exception)(_unexpected)


def require_every_hint(listed: Mapping[str, str]) -> None:
    """Raise LookupError when an error of missing objects has no subject, or its subject no hint: the service must not start.

    An error that is given its subject when it is raised has one of the subjects of ROWS.
    """
    for kind in Missing.__subclasses__():
        subject = vars(kind).get("subject")
        if subject is None and "__init__" not in vars(kind):
            raise LookupError(f"{kind.__module__}.{kind.__name__} needs a subject: the word for what is missing")
        if subject is not None and subject not in listed:
            raise LookupError(f"LISTED of service/api/application.py lacks '{subject}' of {kind.__name__}")


async def _domain_error(request: Request, error: DomainError) -> JSONResponse:
    detail = error.detail + (await _where_to_look(request, error) if isinstance(error, Missing) else "")
    headers = {} if error.retry_after_s is None else {"Retry-After": str(error.retry_after_s)}
    return problem_response(status_of(error), detail, headers, _field_problems(error.field_errors))


async def _where_to_look(request: Request, error: Missing) -> str:
    """Return machines like the one in the path, as far as the client may list them, else where existing objects are listed."""
    name = request.path_params.get("machine_id")
    if error.subject == "machine" and error.args == (name,):
        close = await asyncio.to_thread(_machines_like, request, str(name))
        if close:
            return close
    return str(request.app.state.listed.get(error.subject, ""))


def _machines_like(request: Request, name: str) -> str:
    with database(request).reading() as session:
        return machines_like(session, principal(request), name)


def _field_problems(errors: Iterable[tuple[str, str]]) -> list[FieldProblem]:
    return [FieldProblem(field=field, message=message) for field, message in errors]


async def _wrong_request(request: Request, error: RequestValidationError) -> JSONResponse:
    if _mislabelled(request, error):
        said = request.headers.get("content-type", "nothing")
        detail = f"the body says that it is {said}: send JSON, with Content-Type: application/json"
        return problem_response(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, detail)
    listed = error.errors()[:MOST_PROBLEMS]
    problems = _field_problems(problems_of(_worded(listed), _model_of_body(request)))
    if len(error.errors()) > len(listed):
        words = f"there are more than {MOST_PROBLEMS} problems: mend those that are listed first"
        problems.append(FieldProblem(field="document", message=words))
    return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, "the request is wrong", errors=problems)


async def _http_error(request: Request, error: StarletteHTTPException) -> JSONResponse:
    headers, detail = dict(error.headers or {}), str(error.detail)
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        headers["Allow"] = ", ".join(_methods(request))
        detail = f"{request.method} is not for {request.url.path}: it takes {headers['Allow']}"
    elif error.status_code == HTTPStatus.NOT_FOUND and detail == HTTPStatus.NOT_FOUND.phrase:
        detail = f"there is nothing at {request.url.path}: /api/v1/docs shows what there is"
    elif error.status_code == HTTPStatus.BAD_REQUEST and detail == UNREADABLE:
        detail = "the body cannot be read: it must be JSON in UTF-8, and not nested without end"
    return problem_response(error.status_code, detail, headers)


async def _database_error(request: Request, error: DBAPIError) -> JSONResponse:
    """Answer a database's error. Where data of the machine in the path are damaged, the health reports it as well."""
    told, machine_id = categorized(error), request.path_params.get("machine_id")
    if isinstance(told, Damaged) and machine_id is not None:
        request.app.state.database.damage.record_machine(machine_id)
    return await _domain_error(request, told)


async def _unexpected(_request: Request, error: Exception) -> JSONResponse:
    return problem_response(
        HTTPStatus.INTERNAL_SERVER_ERROR,
        f"unexpected {type(error).__name__}; the log has the details",
        {name.decode(): value.decode() for name, value in ALWAYS},  # answered outside of all middleware
    )


def _mislabelled(request: Request, error: RequestValidationError) -> bool:
    """Check whether a body was not parsed because its Content-Type is not JSON."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    labelled = kind == "application/json" or (kind.startswith("application/") and kind.endswith("+json"))
    return not labelled and any(tuple(one["loc"]) == ("body",) and one["type"] != "missing" for one in error.errors())


def _model_of_body(request: Request) -> type[BaseModel] | None:
    """Return the model that the request's body is of; None where the operation takes none."""
    body = getattr(request.scope.get("route"), "body_field", None)
    kind = None if body is None else body.field_info.annotation
    return kind if isinstance(kind, type) and issubclass(kind, BaseModel) else None


def _worded(errors: Sequence[Any]) -> list[dict[str, Any]]:
    """Return errors with plain field names and without pydantic's own wording."""
    found = []
    for item in errors:
        place, message = tuple(item["loc"]), own_words(item["msg"])
        if item["type"] == "json_invalid":
            place, message = place[:1], f"no JSON from character {place[-1]} on: {item['ctx']['error']}"
        if item["type"] == "string_pattern_mismatch":
            message = WORDS.get(item["ctx"]["pattern"], message)
        found.append(item | {"loc": place[1:] if place[:1] == ("body",) and len(place) > 1 else place, "msg": message})
    return found


def _methods(request: Request) -> list[str]:
    """List the methods of a path over all its routes: each route knows only its own (RFC 9110 §10.2.1)."""
    found: set[str] = set()
    for path, item in request.app.openapi()["paths"].items():
        pattern = "/".join("[^/]+" if part.startswith("{") else re.escape(part) for part in path.split("/"))
        if re.fullmatch(pattern, request.url.path):
            found |= {method.upper() for method in item}
    found = found or {"GET"}
    return sorted(found | {"HEAD"} if "GET" in found else found)
