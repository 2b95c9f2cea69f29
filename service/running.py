"""The service as one process: everything is opened, started, stopped and closed here, in visible steps."""

import gc
import logging
import signal
import socket
import ssl
import sys
import threading
from contextlib import ExitStack
from pathlib import Path
from typing import Protocol

import uvicorn

from service.api.application import application
from service.api.http_protocol import HttpProtocol
from service.api.operations import ENDED
from service.api.server import Server
from service.api.stuck_clients import end_stuck_connections
from service.backup_watch import BackupWatch
from service.closing import Closing
from service.collection import Collector
from service.delivery.dispatcher import Dispatcher
from service.delivery.network import LastStates
from service.delivery.secret_upkeep import opened as opened_secrets
from service.forwarding import Forwarding
from service.housekeeping import Housekeeping
from service.identifying import JobScheduler
from service.ingest import Ingest
from service.job_quota import JobQuota
from service.journal import Journal
from service.leasing import Leasing
from service.memory import share_one_heap
from service.security.audit_watch import AuditWatch
from service.security.certificates import days_left
from service.security.configuration import Security
from service.security.exposure import require_authentication
from service.security.proxies import as_seen, of_proxies
from service.settings import Settings
from service.store_watch import StoreWatch
from service.stream import connected, open_session
from service.stream_access import StreamSecurity
from service.submissions import Submissions
from storage import keys
from storage.database import Database

logger = logging.getLogger(__name__)

SWITCH_INTERVAL_S = 0.0002
"""How long a thread computes before others have a turn [s]: the event loop waits so long whenever it is needed."""


class PortUnusable(RuntimeError):
    """The REST API cannot listen where it should."""


class Part(Protocol):
    """A thread of the service."""

    trouble: str | None

    @property
    def alive(self) -> bool:
        """Whether the thread runs."""

    def start(self) -> None:
        """Begin."""

    def stop(self) -> None:
        """End."""


def serve(settings: Settings) -> None:
    """Run until SIGINT or SIGTERM.

    Raises AccessUnusable, DatabaseUnusable, Exposed, PortUnusable, StreamUnusable before anything starts.
    """
    asked_to_stop = _note_signals()
    share_one_heap()
    stream_security = StreamSecurity.of(settings)
    with ExitStack() as closing:
        database = Database(settings.database)
        closing.callback(database.close)
        with database.reading() as reading:
            for door in require_authentication(settings, keys_are_there=keys.are_there(reading)):
                logger.warning("open to everybody: %s", door)
        database.claim(shared=True)
        _require_certificate(settings)
        logger.info("database: %s", database.version)
        for objection in database.objections:
            logger.warning(objection)
        secrets = opened_secrets(database, settings)
        listener = _listen(settings.host, settings.port)
        closing.callback(listener.close)
        session = open_session(
            listen=settings.zenoh_listen, connect=settings.zenoh_connect, routes=True, security=stream_security
        )
        closing.callback(session.close)
        submissions = Submissions()
        leasing = Leasing(database, settings.role)
        collector = Collector(late_s=settings.late_s)
        journal = Journal(database, collector, leasing)
        ingest = Ingest(session, journal, silence_s=settings.silence_s, submissions=submissions, share=leasing)
        identifying = JobScheduler(database, settings, leasing)
        dispatcher = Dispatcher(database, session, settings, leasing, secrets)
        housekeeping = Housekeeping(database, settings, leasing)
        backup_watch = BackupWatch(settings.backups)
        store_watch = StoreWatch(database)
        store_watch.start()
        closing.callback(store_watch.stop)
        audit_watch = AuditWatch(database)
        parts: dict[str, Part] = {"leasing": leasing}
        if settings.role in ("all", "identify"):
            parts |= {"identifying": identifying, "delivery": dispatcher}
        if settings.role in ("all", "ingest"):
            parts |= {"ingest": ingest, "closing": Closing(database, collector, leasing)}
        for part in [*parts.values(), housekeeping]:
            part.start()
            closing.callback(part.stop)
        for watch in (backup_watch, audit_watch):
            watch.start()
            closing.callback(watch.stop)
        forwarding = Forwarding(session, database, leasing, submissions)
        closing.callback(forwarding.close)
        closing.callback(LastStates(session, database, leasing).close)
        closing.callback(logger.info, "stopping: no more samples; identifications under way are left for the next start")
        if not settings.zenoh_listen and not connected(session):
            logger.warning(_waiting(settings))

        def states() -> dict[str, str]:
            stream = "ok" if settings.zenoh_listen or connected(session) else _waiting(settings)
            return {name: _state(part) for name, part in parts.items()} | {"stream": stream}

        app = application(
            database,
            states,
            try_out=dispatcher.try_out,
            submissions=forwarding,
            baseline_runs=settings.baseline_runs,
            security=Security.of(settings),
            job_quota=JobQuota(settings.asked_jobs_per_principal, settings.asked_jobs_per_machine),
            secrets=secrets,
            warnings=lambda: [
                *housekeeping.warnings,
                *ingest.warnings,
                *identifying.warnings,
                *dispatcher.watch.warnings,
                *audit_watch.warnings,
                *store_watch.warnings,
            ],
            gauges=lambda: (
                {"rundown_longest_transaction_seconds": database.longest_transaction.seconds}
                | housekeeping.gauges
                | ingest.gauges
                | identifying.gauges
                | _certificates(settings)
                | backup_watch.gauges
                | audit_watch.gauges
                | dispatcher.watch.gauges
            ),
        )
        _prefer_answers()
        config = uvicorn.Config(
            app,
            http=HttpProtocol,
            log_config=None,
            access_log=False,
            timeout_graceful_shutdown=5,
            server_header=False,
            # The library by itself believes loopback, or what FORWARDED_ALLOW_IPS says.
            proxy_headers=bool(settings.trusted_proxies),
            forwarded_allow_ips=as_seen(settings.trusted_proxies),
            ssl_certfile=settings.tls_certificate or None,
            ssl_keyfile=settings.tls_key or None,
        )
        host, port = listener.getsockname()[:2]
        scheme = "https" if settings.tls_certificate else "http"
        logger.info("ready: %s://%s:%d/, sources on %s", scheme, host, port, _endpoints(settings))
        if not asked_to_stop.is_set():
            Server(
                config,
                app.state.broadcaster,
                connections_per_address=settings.connections_per_address,
                exempt=of_proxies(settings.trusted_proxies),
            ).run(sockets=[listener])
    logger.info("stopped")


def _certificates(settings: Settings) -> dict[str, float]:
    """How long they are good, where there are some. One that can no longer be read is good for nothing."""
    files = [Path(one) for one in (settings.tls_certificate, settings.zenoh_tls_certificate) if one]
    if not files:
        return {}
    try:
        return {"rundown_certificate_days_left": min(map(days_left, files))}
    except (OSError, ValueError):
        return {"rundown_certificate_days_left": 0.0}


def _prefer_answers() -> None:
    """Let the interpreter's own housekeeping keep nobody waiting."""
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    # What is there by now stays: looking through it again for garbage would stop all threads for a tenth of a second.
    gc.collect()
    gc.freeze()


def _note_signals() -> threading.Event:
    """Take SIGINT and SIGTERM. uvicorn has its own handlers while it runs, and raises the signal once more afterwards:
    without this the process would end there, before anything is closed.
    """
    asked = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: asked.set())
    return asked


def _endpoints(settings: Settings) -> str:
    return ", ".join([*settings.zenoh_listen, *(f"by way of {e}" for e in settings.zenoh_connect)])


def _waiting(settings: Settings) -> str:
    return f"no zenoh router answers at {', '.join(settings.zenoh_connect)} yet; trying again until one does"


def _state(part: Part) -> str:
    if not part.alive:
        return ENDED
    return part.trouble or "ok"


def _require_certificate(settings: Settings) -> None:
    """Find out before anything starts that a certificate cannot be used."""
    if settings.tls_certificate:
        try:
            ssl.create_default_context(ssl.Purpose.CLIENT_AUTH).load_cert_chain(settings.tls_certificate, settings.tls_key)
        except OSError as error:
            raise PortUnusable(
                f"{settings.tls_certificate} with {settings.tls_key}: no certificate and key: {error}"
            ) from error


def _listen(host: str, port: int) -> socket.socket:
    """Take the port before anything else starts, so that one in use is found out at once."""
    listener = socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET, socket.SOCK_STREAM)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        end_stuck_connections(listener)
        listener.bind((host, port))
        listener.listen(128)
    except (OSError, UnicodeError, TypeError) as error:
        listener.close()
        reason = error.strerror if isinstance(error, OSError) else error
        raise PortUnusable(f"cannot listen on {host}:{port}: {reason}; choose another with --host or --port") from error
    return listener
