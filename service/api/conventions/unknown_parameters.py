"""Rejects query parameters that an operation does not know: a misspelt filter would otherwise return unfiltered data."""

from collections.abc import Iterator
from typing import Any, get_args, get_origin

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute

from service.api.conventions.units import wrong_units

UNITS = "units"
NO_UNITS = "leave it out: this answer comes in the units that its fields' names and descriptions say, and in no others"

_names: dict[str, dict[str, bool]] = {}
"""Query parameters of each operation, by its id; True where one may be repeated."""


async def reject_unknown_parameters(request: Request) -> None:
    """Raise RequestValidationError for a parameter that is unknown, holds NUL, or is repeated although it is no list."""
    route = request.scope["route"]
    if not request.scope["query_string"] or not isinstance(route, APIRoute):
        return
    known = _known(route)
    for name, value in request.query_params.multi_items():
        if name == UNITS and UNITS not in known:
            raise wrong_units(value, NO_UNITS)
        if name not in known:
            takes = f"it takes {', '.join(sorted(known))}" if known else "it takes none"
            raise _wrong(name, value, f"this operation knows no such parameter: {takes}")
        if "\0" in value:
            raise _wrong(name, value, "a text must not hold NUL")
    for name, often in known.items():
        given = request.query_params.getlist(name)
        if len(given) > 1 and name == UNITS:
            joined = ",".join(given)
            raise wrong_units(given[-1], f"given {len(given)} times: give it once, with commas between: units={joined}")
        if len(given) > 1 and not often:
            raise _wrong(name, given[-1], f"given {len(given)} times: give it once")


def _known(route: APIRoute) -> dict[str, bool]:
    if route.unique_id not in _names:
        _names[route.unique_id] = dict(_known_parameters(route.dependant))
    return _names[route.unique_id]


def _known_parameters(dependant: Dependant) -> Iterator[tuple[str, bool]]:
    for one in dependant.query_params:
        yield one.alias, _is_list(one.field_info.annotation)
    for below in dependant.dependencies:
        yield from _known_parameters(below)


def _is_list(annotation: Any) -> bool:
    return get_origin(annotation) in (list, set, frozenset, tuple) or any(map(_is_list, get_args(annotation)))


def _wrong(name: str, value: str, message: str) -> RequestValidationError:
    return RequestValidationError([{"type": "value_error", "loc": ("query", name), "msg": message, "input": value}])
