"""`rundown retention`: shows which samples the settings ask to delete, and records a person's confirmation."""

from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.commands.exit import fail
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line

if TYPE_CHECKING:
    from service.maintenance.retention_tiers import Tier
    from storage.database.engine import Database
    from storage.operation.retention import Extent

retention_app = typer.Typer(no_args_is_help=True, help="Old samples: what waits to be deleted.")

COMMAND = "rundown retention"
"""Author in the audit trail of changes made by commands on the store."""


@retention_app.callback()
def _retention() -> None:
    """Group the commands on old samples that wait for deletion."""


@retention_app.command("confirm")
def confirm(
    yes: Annotated[bool, typer.Option("--yes", help="do not ask")] = False,
    database: Annotated[str | None, typer.Option(help="SQLAlchemy URL; by default the setting `database`")] = None,
    as_json: JsonOption = False,
) -> None:
    """Show which old samples are due for deletion by this machine's clock and the service's settings, and confirm it.

    With --json nobody is asked: it needs --yes.

    Run it with the service's settings, whether the service runs or not: its next round, within ten minutes, deletes them.
    """
    from sqlalchemy.exc import DBAPIError

    from service.configuration.settings import SettingsWrong, settings_of
    from service.maintenance.retention_tiers import tiers_of
    from storage.clock import now
    from storage.database.claim import DatabaseUnusable
    from storage.database.engine import Database, require_file

    if as_json and not yes:
        fail("--json asks nobody: say --yes beside it where all that is due may be deleted")
    try:
        settings = settings_of()
        tiers = tiers_of(settings)
        if not tiers:
            fail("nothing is ever deleted: neither raw_days nor run_days is set. Run it with the service's settings")
        url = database or settings.database
        require_file(url)
        opened = Database(url)
    except (DatabaseUnusable, SettingsWrong) as error:
        fail(str(error))
    try:
        moment = now()
        due = {tier.name: _old_samples(opened, tier, moment) for tier in tiers}
        if not as_json:
            _print_old_samples(tiers, due, moment)
        if not yes and not typer.confirm("Is this clock right, and may all of that be deleted for ever?"):
            fail("nothing was confirmed")
        _confirm(opened, tiers, moment)
    except DBAPIError as error:
        fail(f"the database does not answer as it should: {error.orig}")
    finally:
        opened.close()
    if as_json:
        print_json({"confirmed_at": _time(moment), "tiers": [_plain_tier(tier, due[tier.name]) for tier in tiers]})
        return
    print_line("confirmed: the service's next round, within ten minutes, deletes it")


def _print_old_samples(tiers: "list[Tier]", due: "dict[str, dict[str, Extent]]", moment: int) -> None:
    from service.maintenance.retention_cut_offs import DAY_NS

    print_line(f"by this machine's clock it is {_time(moment)}")
    for tier in tiers:
        found = due[tier.name]
        print_line(f"{tier.name}, kept for {tier.kept / DAY_NS:g} days: {_total(found)}")
        for machine_id, extent in found.items():
            print_line(f"  {machine_id:24s} {extent.count:8d}  from {_time(extent.first)} to {_time(extent.last)}")


def _plain_tier(tier: "Tier", due: "dict[str, Extent]") -> dict[str, Any]:
    from service.maintenance.retention_cut_offs import DAY_NS

    extents = {
        machine_id: {"count": one.count, "first": _time(one.first), "last": _time(one.last)} for machine_id, one in due.items()
    }
    return {"name": tier.name, "kept_days": tier.kept / DAY_NS, "machines": extents}


def _old_samples(database: "Database", tier: "Tier", moment: int) -> "dict[str, Extent]":
    """Return the old samples of each machine that has some."""
    from storage.machines import machines

    found = {}
    with database.reading() as session:
        for machine_id in machines.list_ids(session):
            extent = tier.extent(session, machine_id, before=tier.before(session, machine_id, moment=moment))
            if extent is not None:
                found[machine_id] = extent
    return found


def _total(found: "dict[str, Extent]") -> str:
    if not found:
        return "nothing is old enough"
    machines = "1 machine" if len(found) == 1 else f"{len(found)} machines"
    return f"{sum(one.count for one in found.values())} blocks or runs of {machines} are older"


def _confirm(database: "Database", tiers: "list[Tier]", moment: int) -> None:
    from service.maintenance.retention_cut_offs import CutOff
    from storage.operation import audit, retention

    with database.transaction() as session:
        for tier in tiers:
            cut_off = CutOff(moment - tier.kept)
            retention.store_cut_off(session, tier.name, time=cut_off.time, allowance=cut_off.allowance)
            words = f"{tier.name} before {_time(cut_off.time)}"
            audit.append(session, audit.AuditedOperation(COMMAND, "local", "confirm_retention", words, "done"))


def _time(nanoseconds: int) -> str:
    from storage.clock import to_datetime

    return to_datetime(nanoseconds).strftime("%Y-%m-%dT%H:%MZ")
