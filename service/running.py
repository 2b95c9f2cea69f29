"""The service as one process: everything is opened, started, stopped and closed here, in visible steps."""

import logging
import signal
import socket
import threading

import uvicorn

from service.api.application import application
from service.api.stuck_clients import end_stuck_connections
from service.collection import Collector
from service.delivery.dispatcher import Dispatcher
from service.delivery.network import LastStates
from service.identifying import Identifying
from service.ingest import Ingest
from service.journal import Journal
from service.settings import Settings
from service.stream import connected, open_session
from service.submissions import Submissions
from storage.database import Database

logger = logging.getLogger(__name__)


class PortUnusable(RuntimeError):
    """The REST API cannot listen where it should."""


def serve(settings: Settings) -> None:
    """Run until SIGINT or SIGTERM. Raises DatabaseUnusable, PortUnusable or StreamUnusable before anything has started."""
    asked_to_stop = _note_signals()
    database = Database(settings.database)
    database.claim()
    listener = _listen(settings.host, settings.port)
    session = open_session(listen=settings.zenoh_listen, connect=settings.zenoh_connect, routes=True)
    submissions = Submissions()
    ingest = Ingest(
        session, Journal(database, Collector(late_s=settings.late_s)), silence_s=settings.silence_s, submissions=submissions
    )
    identifying = Identifying(database, settings)
    dispatcher = Dispatcher(database, session, settings)
    last_states = LastStates(session, database)

    def parts() -> dict[str, str]:
        return {
            "ingest": _state(alive=ingest.alive, trouble=ingest.trouble),
            "identifying": _state(alive=identifying.alive, trouble=identifying.trouble),
            "delivery": _state(alive=dispatcher.alive, trouble=dispatcher.trouble),
            "stream": "ok" if settings.zenoh_listen or connected(session) else _waiting(settings),
        }

    try:
        identifying.start()
        ingest.start()
        dispatcher.start()
        if not settings.zenoh_listen and not connected(session):
            logger.warning(_waiting(settings))
        app = application(
            database,
            parts,
            try_out=dispatcher.try_out,
            submissions=submissions,
            depth=lambda: ingest.depth,
            baseline_runs=settings.baseline_runs,
        )
        config = uvicorn.Config(app, log_config=None, access_log=False, lifespan="off", timeout_graceful_shutdown=5)
        host, port = listener.getsockname()[:2]
        logger.info("ready: http://%s:%d/, sources on %s", host, port, _endpoints(settings))
        if not asked_to_stop.is_set():
            uvicorn.Server(config).run(sockets=[listener])
    finally:
        logger.info("stopping: no more samples")
        ingest.stop()
        dispatcher.stop()
        last_states.close()
        session.close()
        logger.info("stopping: identifications under way are left for the next start")
        identifying.stop()
        database.close()
        listener.close()
        logger.info("stopped")


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


def _state(*, alive: bool, trouble: str | None) -> str:
    if not alive:
        return "its thread has ended"
    return trouble or "ok"


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
