"""`?units=` that is not heeded: refused, lest somebody takes the numbers for being in the units they asked for."""

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute

from service.api.units import wrong_units

NAME = "units"


async def refuse_unheeded_units(request: Request) -> None:
    """Raises RequestValidationError for `units` that the operation does not declare, or of which only the last would count."""
    given = request.query_params.getlist(NAME)
    route = request.scope["route"]
    if not given or not isinstance(route, APIRoute):
        return
    if not _takes_units(route.dependant):
        message = "leave it out: this answer comes in the units that its fields' names and descriptions say, and in no others"
        raise wrong_units(given[-1], message)
    if len(given) > 1:
        raise wrong_units(given[-1], f"given {len(given)} times: give it once, with commas between: units={','.join(given)}")


def _takes_units(dependant: Dependant) -> bool:
    return any(one.alias == NAME for one in dependant.query_params) or any(map(_takes_units, dependant.dependencies))
