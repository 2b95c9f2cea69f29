"""`?units=` of what does not take it: refused, lest somebody takes the numbers for being in the units they asked for."""

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.exceptions import RequestValidationError
from fastapi.routing import APIRoute

NAME = "units"


async def refuse_undeclared_units(request: Request) -> None:
    """Raises RequestValidationError for `units` where the operation declares no such parameter."""
    route = request.scope["route"]
    if NAME not in request.query_params or not isinstance(route, APIRoute):
        return
    if _takes_units(route.dependant):
        return
    message = "leave it out: this answer comes in the units that its fields' names and descriptions say, and in no others"
    given = request.query_params[NAME]
    raise RequestValidationError([{"type": "value_error", "loc": ("query", NAME), "msg": message, "input": given}])


def _takes_units(dependant: Dependant) -> bool:
    return any(one.alias == NAME for one in dependant.query_params) or any(map(_takes_units, dependant.dependencies))
