"""`rundown key` and `rundown audit`: keys are made on the machine of the store, not over the network."""

import re
import unicodedata
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import typer
from pydantic import TypeAdapter, ValidationError

from estimator.field_types import Identifier
from service.commands.exit import fail, fail_for_unknown_key
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, working
from service.security.role import Role

if TYPE_CHECKING:
    from storage.database.engine import Database
    from storage.tables.operation import ApiKeyRow

key_app = typer.Typer(no_args_is_help=True, help="API keys: who may ask the service, and for what.")
audit_app = typer.Typer(no_args_is_help=True, help="The audit trail.")

DatabaseOption = Annotated[str | None, typer.Option("--database", help="SQLAlchemy URL; by default as for serve")]
KeyDays = Annotated[float, typer.Option(help="until it expires, a hundred years at most")]
Prefix = Annotated[str, typer.Argument(help="the eight characters behind rundown_ by which the key is found")]
A_YEAR = 365.0
ENTRY = "[0-9]{1,18}:[0-9a-f]{64}"
SHORTEST, A_HUNDRED_YEARS = 0.001, 36_500.0
"""Bounds of a key's lifetime [days]."""
LONGEST_NAME = 120
UNWRITTEN = {"Cc": "a control character", "Cs": "no text in UTF-8", "Zl": "a line break", "Zp": "a line break"}
"""Characters that no key's name may hold, by their category in Unicode."""


@key_app.command("create")
def create_key(
    name: Annotated[str, typer.Argument(help="whose it is: a person, or a program")],
    role: Annotated[str, typer.Option(help=", ".join(one.label for one in Role))],
    plant: Annotated[list[str] | None, typer.Option(help="only for this plant; may be given again; by default all")] = None,
    days: KeyDays = A_YEAR,
    database: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Make a key and print it; it is not shown again."""
    from service.security import api_keys
    from storage.clock import now

    try:
        chosen = Role.of(role)
    except ValueError as error:
        fail(str(error))
    _require_name(name)
    for one in plant or ():
        _require_plant(one)
    _require_days("--days", days, least=SHORTEST)
    with _open_store(database, new=True) as opened, opened.transaction() as session:
        row, text = api_keys.create(session, name=name, role=chosen, plants=plant or None, days=days)
        made = _plain_key(row, at=now())
    if as_json:
        print_json({"key": text, **made})
        return
    print_line(text)
    print_line(
        f"{made['prefix']}: {name}, {chosen.label}, until {made['expires_at']}; this is the only time it is shown", err=True
    )


@key_app.command("list")
def list_keys(database: DatabaseOption = None, as_json: JsonOption = False) -> None:
    """List all keys ever made, without their secrets."""
    from storage.clock import now
    from storage.operation import api_keys as keys

    with _open_store(database) as opened, opened.reading() as session:
        moment = now()
        if as_json:
            print_json([_plain_key(row, at=moment) for row in keys.list_all(session)])
            return
        rows = keys.list_all(session)
        if not rows:
            print_line("no key was ever made; the first: rundown key create NAME --role admin")
        for row in rows:
            state = _state(row, at=moment)
            plants = "all plants" if row.plants is None else ",".join(row.plants)
            used = "never used" if row.last_used_at is None else f"last used {_time(row.last_used_at)}"
            print_line(
                f"{row.prefix}  {state:8} {row.role:9} {plants}  until {_time(abs(row.expires_at))}  {used}  {row.name}"
            )


@key_app.command("rotate")
def rotate_key(
    prefix: Prefix,
    overlap_days: Annotated[float, typer.Option(help="how long the old one is good beside the new one")] = 7.0,
    days: KeyDays = A_YEAR,
    database: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Replace a key by a new one, and print it."""
    from service.security import api_keys
    from storage.clock import now
    from storage.operation.api_keys import KeyUnknown

    _require_days("--days", days, least=SHORTEST)
    _require_days("--overlap-days", overlap_days, least=0.0)
    with _open_store(database) as opened:
        try:
            with opened.transaction() as session:
                row, text = api_keys.rotate(session, prefix, overlap_days=overlap_days, days=days)
                made = _plain_key(row, at=now())
        except KeyUnknown:
            fail_for_unknown_key(opened, prefix)
        except ValueError as error:
            fail(str(error))
    if as_json:
        print_json({"key": text, **made, "replaces": prefix, "overlap_days": overlap_days})
        return
    print_line(text)
    print_line(f"{made['prefix']} takes the place of {prefix}, which is good for {overlap_days:g} days more", err=True)


@key_app.command("confirm")
def confirm_key(
    prefix: Annotated[list[str] | None, typer.Argument(help="as `rundown key list` shows it")] = None,
    everyone: Annotated[bool, typer.Option("--all", help="every key that waits")] = False,
    database: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Reactivate keys that a restore brought back and that may have been revoked since the backup."""
    from service.security import api_keys
    from storage.operation import api_keys as keys
    from storage.operation.api_keys import KeyUnknown

    if bool(prefix) == everyone:
        fail("name the keys to confirm, or say --all")
    with _open_store(database) as opened:
        try:
            with opened.transaction() as session:
                chosen = (
                    [row.prefix for row in keys.list_all(session) if keys.awaits_confirmation(row)]
                    if everyone
                    else prefix or []
                )
                for one in chosen:
                    api_keys.confirm(session, one)
        except KeyUnknown as error:
            fail_for_unknown_key(opened, str(error))
        except ValueError as error:
            fail(str(error))
    if as_json:
        print_json({"confirmed": chosen})
        return
    print_line(f"{', '.join(chosen)} confirmed" if chosen else "no key waits for a confirmation")


@key_app.command("revoke")
def revoke_key(prefix: Prefix, database: DatabaseOption = None, as_json: JsonOption = False) -> None:
    """Revoke a key; it stops working within seconds."""
    from service.security import api_keys
    from storage.operation.api_keys import KeyUnknown

    with _open_store(database) as opened:
        try:
            with opened.transaction() as session:
                api_keys.revoke(session, prefix)
        except KeyUnknown:
            fail_for_unknown_key(opened, prefix)
    if as_json:
        print_json({"revoked": prefix})
        return
    print_line(f"{prefix} is revoked")


@audit_app.command("verify")
def verify_audit(
    noted: Annotated[
        list[str] | None, typer.Option(help="NUMBER:HASH that an earlier verify printed or the log has; may be given again")
    ] = None,
    noted_in: Annotated[
        typer.FileText | None,
        typer.Option(errors="replace", help="log of the service, for the notes in it; - is standard input"),
    ] = None,
    database: DatabaseOption = None,
    as_json: JsonOption = False,
) -> None:
    """Check that no entry was changed, removed or moved. Prints the newest number and hash: note them elsewhere.

    Ends with status 1 when a check fails.
    """
    from storage.operation import audit

    known = {_parse_entry(one) for one in noted or ()}
    if noted_in is not None:
        in_log = {
            _parse_entry(found[1]) for found in re.finditer(rf"audit trail: the newest entry is ({ENTRY})", noted_in.read())
        }
        if not in_log:
            fail(f"{noted_in.name} holds no note of the audit trail")
        known |= in_log
    with _open_store(database) as opened, opened.reading() as session, working("looking at every entry"):
        found = audit.verify(session, known=known)
        number, digest = audit.head(session)
    if as_json:
        wrong = [{"entry": one.number, "reason": one.reason} for one in found]
        print_json({"entries": number, "newest": f"{number}:{digest}", "wrong": wrong})
    for one in found:
        print_line(f"entry {one.number}: {one.reason}", err=True)
    if found:
        fail(f"the audit trail does not hold, in {len(found)} places")
    if not as_json:
        print_line(f"{number} entries hold: {number}:{digest}")


def _parse_entry(text: str) -> tuple[int, str]:
    """Parse the number and hash of an entry."""
    if re.fullmatch(ENTRY, text) is None:
        fail(f"'{text}' is not NUMBER:HASH")
    number, _, digest = text.partition(":")
    return int(number), digest


@contextmanager
def _open_store(url: str | None, *, new: bool = False) -> "Iterator[Database]":
    """Open the store, and close it. new: create it if its URL is set explicitly; a default one would serve nobody."""
    from sqlalchemy.exc import DBAPIError

    from service.configuration.settings import SettingsWrong, settings_of
    from storage.database.claim import DatabaseUnusable
    from storage.database.engine import Database, require_file

    try:
        settings = settings_of()
        named = url is not None or {"database", "database_file"} & settings.model_fields_set
        chosen = url or settings.database
        if not (new and named):
            require_file(chosen)
        database = Database(chosen)
    except (DatabaseUnusable, SettingsWrong) as error:
        how = "; --database with its URL makes a new one" if new else ""
        fail(f"{error}{how}")
    try:
        yield database
    except DBAPIError as error:
        fail(f"the database does not answer as it should: {error.orig}")
    finally:
        database.close()


def _plain_key(row: "ApiKeyRow", *, at: int) -> dict[str, Any]:
    return {
        "prefix": row.prefix,
        "state": _state(row, at=at),
        "role": row.role,
        "plants": row.plants,
        "name": row.name,
        "expires_at": _time(abs(row.expires_at)),
        "last_used_at": None if row.last_used_at is None else _time(row.last_used_at),
    }


def _state(row: "ApiKeyRow", *, at: int) -> str:
    from storage.operation import api_keys as keys

    if row.revoked_at:
        return "revoked"
    if keys.awaits_confirmation(row):
        return "waits"
    return "valid" if keys.valid(row, at=at) else "expired"


def _require_name(name: str) -> None:
    """Require a name that a person can read and the database can hold."""
    if not 1 <= len(name) <= LONGEST_NAME:
        fail(f"the name has {len(name)} characters: it must have 1 to {LONGEST_NAME}")
    for place, character in enumerate(name, start=1):
        if unicodedata.category(character) in UNWRITTEN:
            kind = UNWRITTEN[unicodedata.category(character)]
            fail(f"character {place} of the name is {kind} (U+{ord(character):04X}): leave it out")


def _require_plant(name: str) -> None:
    """Require a plant's name as in machine documents: a key for any other name would be useless."""
    try:
        TypeAdapter(Identifier).validate_python(name)
    except ValidationError:
        fail(f"--plant {name!r} is no plant: it must have 1 to 64 letters, digits, '_' and '-'")


def _require_days(option: str, days: float, *, least: float) -> None:
    if not least <= days <= A_HUNDRED_YEARS:  # true for NaN as well
        fail(f"{option} {days:g} must be from {least:g} to {A_HUNDRED_YEARS:g} days, which is a hundred years")


def _time(nanoseconds: int) -> str:
    from storage.clock import to_datetime

    return to_datetime(nanoseconds).strftime("%Y-%m-%dT%H:%MZ")
