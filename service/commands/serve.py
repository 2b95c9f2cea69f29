"""Runs the service as one process: opens, starts, stops and closes everything, in visible steps."""

import gc
import logging
import signal
import sys
import threading
from contextlib import ExitStack
from functools import partial

import uvicorn
import zenoh
from fastapi import FastAPI

from service.advice.site_texts import read_texts
from service.api.application import application, end_waiting
from service.commands.service_threads import ServiceThreads
from service.configuration.settings import Settings
from service.delivery.secret_upkeep import open_secrets as opened_secrets
from service.delivery.signing_secrets import SigningSecrets
from service.delivery.zenoh_channel import LastStates
from service.http.listening_socket import listen, require_certificate
from service.http.protocol import HttpProtocol
from service.http.server import Server
from service.identification.job_quota import JobQuota
from service.ingest.forwarding import Forwarding
from service.messaging.access_control import StreamSecurity
from service.messaging.session import connected, open_session
from service.security.configuration import Security
from service.security.exposure import require_authentication
from service.security.proxies import normalised_networks, proxy_matcher
from storage.database.engine import Database
from storage.operation import api_keys

logger = logging.getLogger(__name__)

SWITCH_INTERVAL_S = 0.0002
"""Longest time that a thread computes before others get a turn [s]: the event loop waits so long whenever it is needed."""


def serve(settings: Settings) -> None:
    """Run until SIGINT or SIGTERM.

    Raises AccessUnusable, DatabaseUnusable, Exposed, PortUnusable, StreamUnusable, TextsWrong before anything starts.
    """
    asked_to_stop = _note_signals()
    stream_security = StreamSecurity.of(settings)
    texts = read_texts(settings.finding_texts, settings.locale)
    with ExitStack() as closing:
        database = _claimed_database(settings, closing)
        secrets = opened_secrets(database, settings)
        listener = listen(settings.host, settings.port)
        closing.callback(listener.close)
        session = open_session(
            listen=settings.zenoh_listen, connect=settings.zenoh_connect, routes=True, security=stream_security
        )
        closing.callback(session.close)
        threads = ServiceThreads(database, session, settings, secrets, texts)
        threads.start(closing)
        forwarding = Forwarding(session, database, threads.leasing, threads.submissions)
        closing.callback(forwarding.close)
        threads.take_from_broker(forwarding, closing)
        closing.callback(LastStates(session, database, threads.leasing, texts).close)
        closing.callback(logger.info, "stopping: no more samples; identifications under way are left for the next start")
        if (trouble := _stream_trouble(session, settings)) is not None:
            logger.warning(trouble)
        app = _application(database, session, settings, secrets, threads, forwarding)
        server = _server(app, settings)
        _favour_short_responses()
        host, port = listener.getsockname()[:2]
        scheme = "https" if settings.tls_certificate else "http"
        logger.info("ready: %s://%s:%d/, sources on %s", scheme, host, port, _endpoints(settings))
        if not asked_to_stop.is_set():
            server.run(sockets=[listener])
    logger.info("stopped")


def _claimed_database(settings: Settings, closing: ExitStack) -> Database:
    """Open and claim the database after the check of access without credentials. Raises DatabaseUnusable, Exposed."""
    database = Database(settings.database)
    closing.callback(database.close)
    with database.reading() as reading:
        for door in require_authentication(settings, keys_are_there=api_keys.any_exist(reading)):
            logger.warning("open to everybody: %s", door)
    database.claim(shared=True)
    require_certificate(settings)
    logger.info("database: %s", database.version)
    for objection in database.objections:
        logger.warning(objection)
    return database


def _application(
    database: Database,
    session: zenoh.Session,
    settings: Settings,
    secrets: SigningSecrets,
    threads: ServiceThreads,
    forwarding: Forwarding,
) -> FastAPI:
    def states() -> dict[str, str]:
        return threads.states() | {"stream": _stream_trouble(session, settings) or "ok"}

    return application(
        database,
        states,
        send_test=threads.dispatcher.send_test,
        submissions=forwarding,
        baseline_runs=settings.baseline_runs,
        security=Security.of(settings),
        job_quota=JobQuota(settings.asked_jobs_per_principal, settings.asked_jobs_per_machine),
        secrets=secrets,
        warnings=threads.warnings,
        gauges=threads.gauges,
        delivery_networks=tuple(settings.delivery_networks),
        texts=threads.texts,
        report_units=settings.report_units,
    )


def _server(app: FastAPI, settings: Settings) -> Server:
    config = uvicorn.Config(
        app,
        http=HttpProtocol,
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=5,
        server_header=False,
        # The library by itself believes loopback, or what FORWARDED_ALLOW_IPS says.
        proxy_headers=bool(settings.trusted_proxies),
        forwarded_allow_ips=normalised_networks(settings.trusted_proxies),
        ssl_certfile=settings.tls_certificate or None,
        ssl_keyfile=settings.tls_key or None,
    )
    return Server(
        config,
        partial(end_waiting, app),
        connections_per_address=settings.connections_per_address,
        exempt=proxy_matcher(settings.trusted_proxies),
    )


def _favour_short_responses() -> None:
    """Tune garbage collection and thread switching for short response times."""
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    # What is there by now stays: looking through it again for garbage would stop all threads for a tenth of a second.
    gc.collect()
    gc.freeze()


def _note_signals() -> threading.Event:
    """Handle SIGINT and SIGTERM, and return the event that they set.

    uvicorn has its own handlers while it runs, and raises the signal again afterwards: without these handlers the process
    would end there, before anything is closed.
    """
    asked = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: asked.set())
    return asked


def _endpoints(settings: Settings) -> str:
    return ", ".join([*settings.zenoh_listen, *(f"by way of {e}" for e in settings.zenoh_connect)])


def _stream_trouble(session: zenoh.Session, settings: Settings) -> str | None:
    """Return the trouble while no configured router answers; None where the service itself listens."""
    if settings.zenoh_listen or connected(session):
        return None
    return f"no zenoh router answers at {', '.join(settings.zenoh_connect)} yet; trying again until one does"
