"""`rundown doctor`: checks a deployment from its settings to its answers, and says what is wrong and what would be right.

It changes nothing, and may run beside the service, with the service's own settings.
"""

import socket
import sqlite3
import ssl
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, Literal, cast
from urllib.parse import urlsplit

import httpx
from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from formats.wire import Key
from service.configuration.hosts import is_loopback
from service.configuration.settings import Settings
from service.delivery.channels import is_channel
from service.delivery.secret_upkeep import SecretReport
from service.delivery.signing_secrets import SigningSecrets
from service.doctor.opcua_greeting import greet
from service.doctor.own_addresses import api_trust, api_url, endpoint_here, reachable
from service.maintenance.store_check import WAITING
from service.messaging.access_control import AccessUnusable, StreamSecurity
from service.messaging.session import StreamUnusable, connected, session
from service.security.certificates import good_until
from storage.alerts import deliveries
from storage.backup.backup_file import newest_in
from storage.backup.restored_access import known_keys
from storage.database import disk, schema
from storage.database.claim import DatabaseUnusable, file_of, in_use, missing_logs, require_own_name
from storage.database.disk import DiskUse
from storage.database.engine import Database, engine_of
from storage.database.errors import error_message as words_of
from storage.database.file_inspection import damages, inspection_engine, revision_beside_a_service
from storage.database.versions import named, objections
from storage.files.private_files import readable_by_others

CheckLevel = Literal["ok", "warning", "wrong"]

CONNECT_S = 5.0
ANSWER_S = 15.0
"""Time limit of the API's answer [s]: a service with a hanging database answers after two bounded waits."""
EXPIRES_SOON_DAYS = 30
BACKUP_EVERY = timedelta(hours=30)
"""Largest age of the newest backup: one made every night is never older."""
SKEW_S = 2.0
"""Largest acceptable difference between the clocks of the database and of this machine [s]."""
FULL = 0.8
PAGES_S = 10.0
"""Time limit for the check of an SQLite file's pages [s]."""


@dataclass(frozen=True)
class CheckResult:
    """Result of one check."""

    level: CheckLevel
    what: str
    words: str


def examine(settings: Settings, *, url: str | None = None, api_key: str | None = None) -> Iterator[CheckResult]:
    """Yield the results of all checks as they come. url: address of the API, by default as the settings say."""
    yield from _database(settings)
    yield from _certificates(settings)
    if settings.backups:
        yield _backups(Path(settings.backups))
    yield from _receivers(settings)
    patience = httpx.Timeout(ANSWER_S, connect=CONNECT_S)
    with httpx.Client(base_url=url or api_url(settings), timeout=patience, verify=api_trust(settings)) as client:
        if api_key:
            client.headers["Authorization"] = f"Bearer {api_key}"
        answers = yield from _api(client)
        machine = (yield from _machines(client)) if answers else None
    yield from _stream(settings, machine)
    yield from _opcua(settings)


def _opcua(settings: Settings) -> Iterator[CheckResult]:
    if not settings.opcua_listen:
        return
    what = "OPC UA"
    if settings.opcua_allow_unencrypted and not is_loopback(settings.opcua_address[0]):
        yield CheckResult("warning", what, "it is offered without encryption beyond this machine: API keys can be overheard")
    host, port = settings.opcua_address
    try:
        greet(reachable(host), port, within_s=CONNECT_S)
    except (OSError, ValueError) as error:
        yield CheckResult("wrong", what, f"{settings.opcua_listen} does not answer: {error}; /health says what ails it")
    else:
        yield CheckResult("ok", what, f"{settings.opcua_listen} answers")


def _database(settings: Settings) -> Iterator[CheckResult]:
    what = "database"
    try:
        engine = engine_of(settings.database)
        path = file_of(engine)
        if path is None:
            yield from _server(settings, engine)
        elif not path.exists():
            yield CheckResult("wrong", what, f"the file {path} is not there: start the service once, or mend RUNDOWN_DATABASE")
        elif in_use(path):
            yield from _file_in_use(settings, path)
        else:
            yield from _file(settings, path)
    except (SQLAlchemyError, DatabaseUnusable, OSError) as error:
        reason = words_of(error).strip().splitlines()[0]
        yield CheckResult("wrong", what, f"cannot be reached: {reason}; is it running, and RUNDOWN_DATABASE right?")


def _server(settings: Settings, engine: Engine) -> Iterator[CheckResult]:
    with engine.connect() as connection:
        yield from _version(engine)
        revision = schema.revision_of(connection)
        skew = _skew(connection) if engine.dialect.name == "postgresql" else 0.0
        yield from _keys(connection)
    yield _schema(revision)
    if skew > SKEW_S:
        yield CheckResult("warning", "clocks", f"the database's clock differs by {skew:.1f} s: let both follow NTP")
    if revision is not None:
        yield from _webhook_secrets(settings, engine)
        yield from _subscription_kinds(engine)
    engine.dispose()
    if revision == schema.known_revisions()[0]:  # opening an older one would bring it up to date
        yield _disk_room(settings, lambda budget: _used(settings, budget))


def _file_in_use(settings: Settings, path: Path) -> Iterator[CheckResult]:
    """Check a file through the running service, not by opening it: that would replace a deleted log by a new one."""
    require_own_name(path)
    if missing := missing_logs(path):
        names = " and ".join(one.name for one in missing)
        words = f"{names} is missing though a service runs on {path}: stop it cleanly, which saves all it has"
        yield CheckResult("wrong", "database", f"{words}; do not open the file with anything before")
    else:
        yield from _version(engine_of(settings.database))
    yield from _readable(path)
    revision = revision_beside_a_service(path)
    yield (
        _schema(revision)
        if revision
        else CheckResult("ok", "schema", "is the running service's, and not in its main file yet")
    )
    yield _disk_room(settings, lambda budget: disk.used_by_file(path, budget=budget))


def _file(settings: Settings, path: Path) -> Iterator[CheckResult]:
    """Check a file that no service has open, without changing it."""
    with inspection_engine(path) as engine, engine.connect() as connection:
        revision = schema.revision_of(connection)
        yield from _version(engine)
        yield from _readable(path)
        yield _schema(revision)
        if revision is not None:
            yield from _webhook_secrets(settings, engine)
            yield from _subscription_kinds(engine)
        yield from _keys(connection)
        yield _pages(cast(sqlite3.Connection, connection.connection.driver_connection), path)
    yield _disk_room(settings, lambda budget: disk.used_by_file(path, budget=budget))


def _keys(connection: Connection) -> Iterator[CheckResult]:
    """Yield a warning if keys await confirmation since a restore."""
    waiting = sum(one.expires_at < 0 and one.revoked_at is None for one in known_keys(connection).values())
    if waiting:
        yield CheckResult("warning", "API keys", WAITING.format(waiting))


def _pages(connection: sqlite3.Connection, path: Path) -> CheckResult:
    """Check whether the file is damaged."""
    found = damages(connection, within_s=PAGES_S)
    if found is None:
        return CheckResult(
            "ok", "pages", f"{path} was looked through for {PAGES_S:.0f} s, not to its end; a backup looks at all"
        )
    if found:
        return CheckResult("wrong", "pages", f"{path} is damaged: {'; '.join(found)}: look at the disk, and restore a backup")
    return CheckResult("ok", "pages", f"{path} is whole")


def _version(engine: Engine) -> Iterator[CheckResult]:
    yield CheckResult("ok", "database", f"{named(engine)} answers")
    for objection in objections(engine):
        yield CheckResult("warning", "database", objection)


def _readable(path: Path) -> Iterator[CheckResult]:
    if files := readable_by_others(path):
        names = " ".join(map(str, files))
        yield CheckResult("warning", "database file", f"others may read it, and secrets in it: chmod 600 {names}")


def _schema(revision: str | None) -> CheckResult:
    known = schema.known_revisions()
    if revision is None:
        return CheckResult("warning", "schema", "there is none yet: the service makes it at its first start")
    if revision == known[0]:
        return CheckResult("ok", "schema", f"revision {revision}, as this release needs it")
    if revision in known:
        return CheckResult(
            "warning", "schema", f"revision {revision}, older than {known[0]}: the next start brings it up to date"
        )
    return CheckResult("wrong", "schema", f"revision {revision} is of a newer release: upgrade this one, or restore a backup")


def _skew(connection: Any) -> float:
    before = time.time()
    there = float(connection.scalar(text("SELECT extract(epoch FROM clock_timestamp())")))
    return max(0.0, abs(there - before) - (time.time() - before))


def _used(settings: Settings, budget: int | None) -> DiskUse:
    with closing(Database(settings.database)) as database:
        return disk.used(database, budget=budget)


def _disk_room(settings: Settings, used: Callable[[int | None], DiskUse]) -> CheckResult:
    try:
        use = used(int(settings.disk_budget_gb * 1e9) or None)
    except (DatabaseUnusable, SQLAlchemyError, OSError) as error:
        return CheckResult("warning", "room", f"unknown: {error}")
    left = "" if use.free is None else f", {use.free / 1e9:.1f} GB are free"
    taken = f"the data take {use.data / 1e9:.2f} GB{left}"
    if use.part is None:
        unseen = "how much room they have is not seen from here, and disk_budget_gb is not set"
        return CheckResult("warning", "room", f"{taken}; {unseen}: without RUNDOWN_DISK_BUDGET_GB nothing warns in time")
    level: CheckLevel = "ok" if use.part < FULL else "warning"
    return CheckResult(level, "room", f"{taken}; {100 * use.part:.0f} % of the room are used")


def _subscription_kinds(engine: Engine) -> Iterator[CheckResult]:
    """Yield a fault for each subscription of an unknown kind, made by another release."""
    what = "subscriptions"
    try:
        with Session(engine) as session:
            unknown = [(row.name, row.kind) for row in deliveries.list_subscriptions(session) if not is_channel(row.kind)]
    except SQLAlchemyError as error:
        yield CheckResult("warning", what, f"cannot be checked: {words_of(error)}")
        return
    for name, kind in unknown:
        yield CheckResult("wrong", what, f"'{name}' is told nothing: this release knows no subscriptions of kind '{kind}'")


def _webhook_secrets(settings: Settings, engine: Engine) -> Iterator[CheckResult]:
    what = "webhook secrets"
    try:
        with Session(engine) as session:
            rows = deliveries.list_subscriptions_with_secret(session)
            found = SecretReport.at(rows, SigningSecrets.of(settings))
    except SQLAlchemyError as error:
        yield CheckResult("warning", what, f"cannot be checked: {words_of(error)}")
        return
    for words in found.unsigned:
        yield CheckResult("wrong", what, words)
    for words in found.plain:
        yield CheckResult("warning", what, words)
    if rows and not found.unsigned and not found.plain:
        yield CheckResult("ok", what, f"all of the {len(rows)} that there are can be read, and none is stored unencrypted")


def _certificates(settings: Settings) -> Iterator[CheckResult]:
    for what, file in (
        ("API certificate", settings.tls_certificate),
        ("zenoh certificate", settings.zenoh_tls_certificate),
        ("MQTT certificate", settings.mqtt_tls_certificate),
        ("OPC UA certificate", settings.opcua_certificate),
    ):
        if file:
            yield _certificate(what, Path(file))
    if not settings.tls_certificate and not is_loopback(settings.host):
        yield CheckResult("warning", "API certificate", "the API speaks plain HTTP beyond this machine: keys can be overheard")
    try:
        StreamSecurity.of(settings)
    except AccessUnusable as error:
        yield CheckResult("wrong", "zenoh access", str(error))


def _certificate(what: str, file: Path) -> CheckResult:
    try:
        until = good_until(file)
    except (OSError, ValueError) as error:
        return CheckResult("wrong", what, f"{file} cannot be read: {error}")
    days = (until - datetime.now(UTC)).days
    if days < 0:
        return CheckResult("wrong", what, f"{file} has expired on {until:%Y-%m-%d}: make a new one")
    level: CheckLevel = "warning" if days < EXPIRES_SOON_DAYS else "ok"
    return CheckResult(level, what, f"{file} is good for {days} days")


def _backups(folder: Path) -> CheckResult:
    try:
        newest = newest_in(folder)
    except OSError as error:
        return CheckResult("wrong", "backups", f"{folder} cannot be read: {error.strerror}")
    if newest is None:
        return CheckResult("wrong", "backups", f"there is none in {folder}: rundown backup FILE makes one")
    old = datetime.now(UTC) - newest > BACKUP_EVERY
    return CheckResult("warning" if old else "ok", "backups", f"the newest in {folder} is of {newest:%Y-%m-%d %H:%M} UTC")


def _receivers(settings: Settings) -> Iterator[CheckResult]:
    """Check the mail server, the issuer and the Dask scheduler."""
    if settings.smtp_host:
        yield _check_connection("mail server", settings.smtp_host, settings.smtp_port)
    if settings.oidc_issuer:
        yield _issuer(settings.oidc_issuer)
    if settings.mqtt_url:
        yield from _broker(settings)
    if settings.dask_scheduler:
        where = urlsplit(settings.dask_scheduler)
        yield _check_connection("Dask scheduler", where.hostname or "", where.port or 8786)


def _broker(settings: Settings) -> Iterator[CheckResult]:
    """Check whether the MQTT broker lets the service in, and whether others can read what goes there."""
    from service.mqtt.probe import refusal  # nobody else needs its library

    what, (host, _) = "MQTT broker", settings.mqtt_broker
    refused = refusal(settings)
    if refused is not None:
        yield CheckResult("wrong", what, f"{settings.mqtt_url} cannot be used: {refused}; look at RUNDOWN_MQTT_… and its log")
    else:
        yield CheckResult("ok", what, f"{settings.mqtt_url} lets '{settings.mqtt_user or 'anybody'}' in")
    if not settings.mqtt_encrypted and not is_loopback(host):
        yield CheckResult("warning", what, "it is spoken to without TLS: samples can be read and made up on their way")


def _check_connection(what: str, host: str, port: int) -> CheckResult:
    try:
        socket.create_connection((host, port), timeout=CONNECT_S).close()
    except OSError as error:
        return CheckResult("wrong", what, f"{host}:{port} does not answer: {error}")
    return CheckResult("ok", what, f"{host}:{port} answers")


def _issuer(issuer: str) -> CheckResult:
    url = issuer.rstrip("/") + "/.well-known/openid-configuration"
    try:
        told = httpx.get(url, timeout=CONNECT_S).raise_for_status().json().get("issuer")
    except (httpx.HTTPError, ValueError) as error:
        return CheckResult("wrong", "issuer", f"{url} does not answer as it should: {error}")
    if told != issuer:
        return CheckResult(
            "wrong", "issuer", f"it calls itself {told}, RUNDOWN_OIDC_ISSUER says {issuer}: they must be the same"
        )
    return CheckResult("ok", "issuer", f"{issuer} answers")


def _api(client: httpx.Client) -> Generator[CheckResult, None, bool]:
    """Check whether the API answers, and return it."""
    try:
        answer = client.get("/api/v1/ready")
        told = answer.json()
    except (httpx.TransportError, ValueError, ssl.SSLError) as error:
        yield CheckResult("wrong", "API", f"{client.base_url} does not answer: {error}; is the service running?")
        return False
    if not isinstance(told, dict) or "parts" not in told:
        yield CheckResult("wrong", "API", f"what answers at {client.base_url} is not Rundown")
        return False
    yield CheckResult("ok", "API", f"{client.base_url} answers")
    for name, state in told["parts"].items():
        yield CheckResult("ok" if state == "ok" else "wrong", name, state)
    for warning in told.get("warnings", []):
        if not warning.startswith(("SQLite", "PostgreSQL")):  # said already
            yield CheckResult("warning", "service", warning)
    return True


class _NoAnswer(RuntimeError):
    """The API does not give the expected answer; the message holds what it said."""


class _KeyRequired(RuntimeError):
    """The API requires a key."""


def _machines(client: httpx.Client) -> Generator[CheckResult, None, Key | None]:
    """Check the machines and sources that the service knows; return a machine's key."""
    try:
        first = _get_list(client, "/api/v1/machines?limit=1")
        sources = _get_list(client, "/api/v1/sources")
    except _KeyRequired:
        words = (
            "the rest needs a key of a viewer or more: give one with --api-key-file (after a restore, one that is confirmed)"
        )
        yield CheckResult("warning", "API key", words)
        return None
    except _NoAnswer as error:
        yield CheckResult("wrong", "machines", str(error))
        return None
    if not first:
        yield CheckResult("warning", "machines", "none is known: POST a document to /api/v1/machines")
        return None
    for source in sources:
        if source.get("lost"):
            words = f"{source['lost']} samples never came: does it keep a log?"
            yield CheckResult("warning", f"source {source['machine']}/{source['source']}", words)
    yield CheckResult("ok", "machines", f"{first[0]['id']} and perhaps others are known")
    return Key(first[0]["plant"], first[0]["id"])


def _get_list(client: httpx.Client, path: str) -> list[dict[str, Any]]:
    """Return a list from the API. Raises _KeyRequired, _NoAnswer."""
    try:
        answer = client.get(path)
        told = answer.json()
    except (httpx.TransportError, ValueError) as error:
        raise _NoAnswer(f"{path} is not answered: {error}") from error
    if answer.status_code in (httpx.codes.UNAUTHORIZED, httpx.codes.FORBIDDEN):
        raise _KeyRequired
    if not isinstance(told, list):
        detail = told.get("detail") if isinstance(told, dict) else told
        raise _NoAnswer(f"{path} is answered with {answer.status_code}: {detail}")
    return told


def _stream(settings: Settings, machine: Key | None) -> Iterator[CheckResult]:
    """Check whether a zenoh session reaches the service, and through it the store."""
    endpoints = settings.zenoh_connect or [endpoint_here(one) for one in settings.zenoh_listen]
    what = "zenoh"
    try:
        with session(listen=[], connect=endpoints, security=StreamSecurity.of(settings)) as opened:
            if not _wait_for(lambda: connected(opened)):
                yield CheckResult(
                    "wrong", what, f"nobody answers at {', '.join(endpoints)}: is a router or the service there?"
                )
                return
            yield CheckResult("ok", what, f"{', '.join(endpoints)} answers")
            if machine is None:
                return
            replies = [reply.ok for reply in opened.get(machine.received, timeout=CONNECT_S) if reply.ok is not None]
    except (StreamUnusable, AccessUnusable) as error:
        yield CheckResult("wrong", what, str(error))
        return
    if replies:
        yield CheckResult(
            "ok", "way to the store", f"it is said over zenoh how far {machine.plant}/{machine.machine} is stored"
        )
    else:
        yield CheckResult(
            "wrong", "way to the store", f"nobody says over zenoh how far {machine.plant}/{machine.machine} is stored"
        )


def _wait_for(look: Callable[[], bool]) -> bool:
    deadline = time.monotonic() + CONNECT_S
    while not look():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.05)
    return True
