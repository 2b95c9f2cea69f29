"""`rundown doctor --exposed`: the endpoints that somebody on the network could reach, with the reasons."""

from service.commands.exit import fail
from service.commands.json_output import print_json
from service.commands.terminal import print_line, print_text
from service.configuration.settings import Settings
from service.doctor.endpoint_probes import probe_endpoints
from service.doctor.exposed_endpoints import credentials_asked, endpoint_lines, exposed_endpoints
from storage.database.claim import DatabaseUnusable


def report(settings: Settings, *, url: str | None = None, as_json: bool = False) -> None:
    """Print every endpoint, worst first, with the results of probing; end with status 1 when one is open."""
    try:
        found = exposed_endpoints(settings)
        asked, _ = credentials_asked(settings)
    except DatabaseUnusable as error:
        fail(str(error))
    if not as_json:
        for door in found:
            print_text(endpoint_lines(door))
    looks = list(probe_endpoints(settings, asked=asked, url=url))
    if as_json:
        print_json({"endpoints": found, "tried": looks})
    for look in looks if not as_json else ():
        print_line(f"{look.level:9s} tried: {look.what}: {look.words}")
    open_doors = sum(door.level == "open" for door in found) + sum(look.level == "open" for look in looks)
    if open_doors:
        fail(f"{open_doors} open to everybody on the network: docs/security.md says how to close them")
