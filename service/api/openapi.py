"""The OpenAPI document: FastAPI's, with every error as a problem detail."""

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from service.http.idempotency import KEY_PATTERN, LONGEST_KEY

PROBLEM = "#/components/schemas/Problem"
VALIDATION = ("HTTPValidationError", "ValidationError")
"""Schemas of FastAPI's own 422 response, which this API does not use."""
NEXT = {
    "description": 'where the next part of the list is: `<address>; rel="next"`; not there on the last one (RFC 8288)',
    "schema": {"type": "string"},
}
ETAG = {"description": "of this state, for If-Match", "schema": {"type": "string"}}
BEARER = {
    "type": "http",
    "scheme": "bearer",
    "description": "an API key, or a token of the issuer; not needed on loopback as long as there is neither",
}
IDEMPOTENCY_KEY = {
    "name": "Idempotency-Key",
    "in": "header",
    "required": False,
    "description": "a new one for each request, such as a UUID: asked twice under the same key within a day, it is done once",
    "schema": {"type": "string", "minLength": 1, "maxLength": LONGEST_KEY, "pattern": KEY_PATTERN},
}


def described(app: FastAPI) -> dict[str, Any]:
    """Return the document of an application, built on the first call."""
    if app.openapi_schema is None:
        document = get_openapi(
            title=app.title, version=app.version, description=app.description, routes=app.routes, openapi_version="3.1.0"
        )
        for item in document["paths"].values():
            for method, operation in item.items():
                _describe(method, operation)
        _describe_security(app, document)
        for name in VALIDATION:
            document["components"]["schemas"].pop(name, None)
        app.openapi_schema = document
    return app.openapi_schema


def _describe(method: str, operation: dict[str, Any]) -> None:
    responses = operation["responses"]
    for response in responses.values():
        if any(_is_problem(content) for content in response.get("content", {}).values()):
            response["content"] = {"application/problem+json": {"schema": {"$ref": PROBLEM}}}
    responses["default"] = _problem("any other problem, in the same shape")
    names = {parameter["name"].lower() for parameter in operation.get("parameters", [])}
    succeeded = next(response for code, response in responses.items() if code.startswith("2"))
    if "cursor" in names:
        succeeded.setdefault("headers", {})["Link"] = NEXT
    if "if-match" in names:
        succeeded.setdefault("headers", {})["ETag"] = ETAG
        for status in (HTTPStatus.PRECONDITION_FAILED, HTTPStatus.PRECONDITION_REQUIRED):
            responses[str(status.value)] = _problem(status.phrase)
        # Required, although a missing one is answered by 428 and not by 422: only the condition is missing.
        next(one for one in operation["parameters"] if one["name"].lower() == "if-match")["required"] = True
    if method == "post":
        operation.setdefault("parameters", []).append(IDEMPOTENCY_KEY)


def _problem(description: str) -> dict[str, Any]:
    return {"description": description, "content": {"application/problem+json": {"schema": {"$ref": PROBLEM}}}}


def _describe_security(app: FastAPI, document: dict[str, Any]) -> None:
    document["components"]["securitySchemes"] = {"bearer": BEARER}
    document["security"] = [{"bearer": []}, {}]
    for one in app.state.operations:
        for method in one.methods:
            operation = document["paths"].get(one.path, {}).get(method.lower())
            if operation is not None:
                operation["x-needs"] = one.requirement.words
                if one.requirement.role is None:
                    operation["security"] = []


def _is_problem(content: dict[str, Any]) -> bool:
    reference: str = content.get("schema", {}).get("$ref", "")
    return reference == PROBLEM or reference.endswith(VALIDATION)
