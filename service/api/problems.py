"""Errors as problem details (RFC 9457): one shape for every error of the API."""

import re
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, Field
from sqlalchemy.exc import DataError, DBAPIError
from starlette.exceptions import HTTPException as StarletteHTTPException

from estimator.machine import DocumentError, problems_of
from estimator.slow_roll import NotSlowRoll
from service.alert_life import Forbidden
from service.alerting import MomentRefused
from service.api.patterns import WORDS
from service.api.preconditions import PreconditionMissing, Stale
from service.baselining import BaselineRefused, NotYet
from service.delivery.addresses import TargetRefused
from service.delivery.signing_secrets import SecretUnusable
from service.identified import NoModel
from service.job_quota import RETRY_AFTER_S, QuotaExceeded
from service.known_parameters import ParameterUnknown
from service.limits import LimitsRefused
from service.requesting import NotToIdentify
from service.security.answer_headers import ALWAYS
from service.setting_limits import LimitsChanged
from storage.alerts import AlertUnknown
from storage.blocks import DamagedBlock
from storage.claim import DatabaseUnusable
from storage.damage import is_damage, said
from storage.deliveries import DeliveryUnknown, SubscriptionDisabled, SubscriptionExists, SubscriptionUnknown
from storage.identifications import IdentificationUnknown
from storage.jobs import JobUnknown
from storage.machines import MachineExists, MachineUnknown, PlantChanged, RevisionUnknown
from storage.runs import RunUnknown, SamplesReleased
from storage.slow_roll import SlowRollUnknown
from storage.suppressions import SuppressionUnknown


class FieldProblem(BaseModel):
    """What is wrong with one field."""

    field: str
    message: str


class Problem(BaseModel):
    """A problem detail."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[FieldProblem] = Field(default_factory=list)


class Unsuitable(ValueError):
    """What is asked for cannot be made from what is given, and why."""


UNREADABLE = "There was an error parsing the body"
"""What the framework says of a body that is no JSON at all."""
OF_MACHINE = "GET /api/v1/machines/<id>"

_STATUS: Mapping[type[Exception], tuple[HTTPStatus, str]] = {
    MachineUnknown: (HTTPStatus.NOT_FOUND, "no machine {0}: GET /api/v1/machines lists those there are"),
    RevisionUnknown: (HTTPStatus.NOT_FOUND, f"no revision {{0}}: {OF_MACHINE}/revisions lists them"),
    ParameterUnknown: (HTTPStatus.NOT_FOUND, "no parameter {0}"),
    RunUnknown: (HTTPStatus.NOT_FOUND, f"no run {{0}}: {OF_MACHINE}/runs lists those of a machine"),
    IdentificationUnknown: (
        HTTPStatus.NOT_FOUND,
        f"no identification {{0}}: {OF_MACHINE}/identifications lists them",
    ),
    SlowRollUnknown: (HTTPStatus.NOT_FOUND, f"no slow-roll vectors: {{0}}; {OF_MACHINE}/slow-roll lists the versions"),
    NotSlowRoll: (HTTPStatus.UNPROCESSABLE_ENTITY, "no slow roll: {0}"),
    Unsuitable: (HTTPStatus.UNPROCESSABLE_ENTITY, "{0}"),
    NoModel: (HTTPStatus.CONFLICT, "{0}"),
    SamplesReleased: (HTTPStatus.GONE, "{0}"),
    DamagedBlock: (HTTPStatus.INTERNAL_SERVER_ERROR, "{0}; look at the disk, and restore a backup"),
    NotToIdentify: (HTTPStatus.CONFLICT, "{0}"),
    JobUnknown: (HTTPStatus.NOT_FOUND, f"no job {{0}}: {OF_MACHINE}/jobs lists those of a machine"),
    AlertUnknown: (HTTPStatus.NOT_FOUND, "no alert {0}: GET /api/v1/alerts lists those there are"),
    SuppressionUnknown: (HTTPStatus.NOT_FOUND, f"no suppression {{0}}: {OF_MACHINE}/suppressions lists those in force"),
    SubscriptionUnknown: (HTTPStatus.NOT_FOUND, "no subscription {0}: GET /api/v1/subscriptions lists those there are"),
    DeliveryUnknown: (
        HTTPStatus.NOT_FOUND,
        "no delivery {0}: GET /api/v1/subscriptions/<id>/deliveries lists them",
    ),
    Forbidden: (HTTPStatus.CONFLICT, "{0}"),
    BaselineRefused: (HTTPStatus.CONFLICT, "{0}"),
    NotYet: (HTTPStatus.UNPROCESSABLE_ENTITY, "{0}"),
    SubscriptionExists: (HTTPStatus.CONFLICT, "{0}"),
    SubscriptionDisabled: (HTTPStatus.CONFLICT, "{0}"),
    TargetRefused: (HTTPStatus.UNPROCESSABLE_ENTITY, "{0}"),
    SecretUnusable: (HTTPStatus.CONFLICT, "{0}"),
    LimitsChanged: (HTTPStatus.PRECONDITION_FAILED, "{0}"),
    PreconditionMissing: (HTTPStatus.PRECONDITION_REQUIRED, "{0}"),
    Stale: (HTTPStatus.PRECONDITION_FAILED, "{0}"),
    MachineExists: (HTTPStatus.CONFLICT, "{0}"),
    PlantChanged: (HTTPStatus.CONFLICT, "{0}"),
    DatabaseUnusable: (HTTPStatus.SERVICE_UNAVAILABLE, "{0}"),
}


def problem_response(
    status: int, detail: str, headers: Mapping[str, str] | None = None, errors: list[FieldProblem] | None = None
) -> JSONResponse:
    """A problem detail as the answer to a request."""
    problem = Problem(title=HTTPStatus(status).phrase, status=status, detail=detail, errors=errors or [])
    return JSONResponse(problem.model_dump(), status, dict(headers or {}), media_type="application/problem+json")


def add_handlers(app: FastAPI) -> None:
    """Make the application answer every error with a problem detail."""

    async def known(_request: Request, error: Exception) -> JSONResponse:
        status, text = _STATUS[type(error)]
        return problem_response(status, text.format(error.args[0] if error.args else error))

    for kind in _STATUS:
        app.add_exception_handler(kind, known)

    @app.exception_handler(DocumentError)
    async def document(_request: Request, error: DocumentError) -> JSONResponse:
        problems = [FieldProblem(field=field, message=message) for field, message in error.problems]
        return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, "the machine document is wrong", errors=problems)

    @app.exception_handler(LimitsRefused)
    async def limits(_request: Request, error: LimitsRefused) -> JSONResponse:
        problems = [FieldProblem(field=f"limits.{field}", message=message) for field, message in error.problems]
        return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, "the limits do not suit the machine", errors=problems)

    @app.exception_handler(QuotaExceeded)
    async def wait(_request: Request, error: QuotaExceeded) -> JSONResponse:
        return problem_response(HTTPStatus.TOO_MANY_REQUESTS, str(error), {"Retry-After": str(RETRY_AFTER_S)})

    @app.exception_handler(MomentRefused)
    async def moment(_request: Request, error: MomentRefused) -> JSONResponse:
        problems = [FieldProblem(field="until", message=str(error))]
        return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, "the request is wrong", errors=problems)

    @app.exception_handler(RequestValidationError)
    async def wrong(request: Request, error: RequestValidationError) -> JSONResponse:
        if _mislabelled(request, error):
            said = request.headers.get("content-type", "nothing")
            detail = f"the body says that it is {said}: send JSON, with Content-Type: application/json"
            return problem_response(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, detail)
        problems = [FieldProblem(field=field, message=message) for field, message in problems_of(_worded(error))]
        return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, "the request is wrong", errors=problems)

    @app.exception_handler(StarletteHTTPException)
    async def http(request: Request, error: StarletteHTTPException) -> JSONResponse:
        headers, detail = dict(error.headers or {}), str(error.detail)
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["Allow"] = ", ".join(_methods(app, request))
            detail = f"{request.method} is not for {request.url.path}: it takes {headers['Allow']}"
        elif error.status_code == HTTPStatus.NOT_FOUND and detail == HTTPStatus.NOT_FOUND.phrase:
            detail = f"there is nothing at {request.url.path}: /api/v1/docs shows what there is"
        elif error.status_code == HTTPStatus.BAD_REQUEST and detail == UNREADABLE:
            detail = "the body cannot be read: it must be JSON in UTF-8, and not nested without end"
        return problem_response(error.status_code, detail, headers)

    @app.exception_handler(DataError)
    async def unstorable(_request: Request, error: DataError) -> JSONResponse:
        return problem_response(HTTPStatus.UNPROCESSABLE_ENTITY, f"the database cannot hold or look for that: {error.orig}")

    @app.exception_handler(DBAPIError)
    async def no_database(request: Request, error: DBAPIError) -> JSONResponse:
        if is_damage(error):
            return _damaged(request, error)
        return problem_response(HTTPStatus.SERVICE_UNAVAILABLE, f"the database does not answer: {error.orig}")

    @app.exception_handler(Exception)
    async def unexpected(_request: Request, error: Exception) -> JSONResponse:
        return problem_response(
            HTTPStatus.INTERNAL_SERVER_ERROR,
            f"unexpected {type(error).__name__}; the log has the details",
            {name.decode(): value.decode() for name, value in ALWAYS},  # answered outside of all middleware
        )


def _damaged(request: Request, error: DBAPIError) -> JSONResponse:
    """Where the path says whose data they are, that is told by the service's health, too."""
    machine_id = request.path_params.get("machine_id")
    if machine_id is not None:
        request.app.state.database.damage.concerns(machine_id)
    detail = f"what is stored is damaged, and cannot be read: {said(error)}; look at the disk, and restore a backup"
    return problem_response(HTTPStatus.SERVICE_UNAVAILABLE, detail)


def _mislabelled(request: Request, error: RequestValidationError) -> bool:
    """Whether a body was not looked into because it is not called JSON."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    labelled = kind == "application/json" or (kind.startswith("application/") and kind.endswith("+json"))
    return not labelled and any(tuple(one["loc"]) == ("body",) and one["type"] != "missing" for one in error.errors())


def _worded(error: RequestValidationError) -> list[dict[str, Any]]:
    """The errors with fields of the body by their own names, and in words without pydantic's own."""
    found = []
    for item in error.errors():
        place, message = tuple(item["loc"]), item["msg"].removeprefix("Value error, ")
        if item["type"] == "json_invalid":
            place, message = place[:1], f"no JSON from character {place[-1]} on: {item['ctx']['error']}"
        if item["type"] == "string_pattern_mismatch":
            message = WORDS.get(item["ctx"]["pattern"], message)
        found.append(item | {"loc": place[1:] if place[:1] == ("body",) and len(place) > 1 else place, "msg": message})
    return found


def _methods(app: FastAPI, request: Request) -> list[str]:
    """What a path can be asked for: each route knows only its own method (RFC 9110 §10.2.1)."""
    found: set[str] = set()
    for path, item in app.openapi()["paths"].items():
        pattern = "/".join("[^/]+" if part.startswith("{") else re.escape(part) for part in path.split("/"))
        if re.fullmatch(pattern, request.url.path):
            found |= {method.upper() for method in item}
    found = found or {"GET"}
    return sorted(found | {"HEAD"} if "GET" in found else found)


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
