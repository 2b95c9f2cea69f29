"""The web application over a database, served by a real server in this process."""

import os
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

import uvicorn
from fastapi import FastAPI

from service.api.application import application, end_waiting
from service.configuration.settings import DEFAULT_CONNECTIONS_PER_ADDRESS
from service.delivery.signing_secrets import SigningSecrets
from service.http.protocol import HttpProtocol
from service.http.server import Server
from service.http.slow_clients import PATIENCE_S, end_stuck_connections
from service.secrets.files import KEY_BYTES
from service.secrets.sealing import Sealing
from storage.database.engine import Database


@contextmanager
def served(database: Database, **application_parts: Any) -> Iterator[str]:
    """Yield the URL of the API, until the block ends."""
    secrets = SigningSecrets(Sealing([os.urandom(KEY_BYTES)]))
    with serving(application(database, dict, secrets=secrets, **application_parts)) as url:
        yield url


@contextmanager
def serving(
    app: FastAPI,
    *,
    patience_s: float = PATIENCE_S,
    connections_per_address: int = DEFAULT_CONNECTIONS_PER_ADDRESS,
    port: int = 0,
) -> Iterator[str]:
    """Yield the URL of an application's API, until the block ends. patience_s: with clients that read nothing; port: 0 takes a
    free one."""
    listener = socket.create_server(("127.0.0.1", port))
    end_stuck_connections(listener, after_s=patience_s)
    configuration = uvicorn.Config(app, http=HttpProtocol, log_config=None, access_log=False, timeout_graceful_shutdown=1)
    server = Server(configuration, partial(end_waiting, app), connections_per_address=connections_per_address)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/api/v1"
    finally:
        server.should_exit = True
        thread.join()
        listener.close()
