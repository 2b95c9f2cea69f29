"""The web application over a database, served by a real server in this process."""

import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn

from service.api.application import application
from storage.database import Database


@contextmanager
def served(database: Database) -> Iterator[str]:
    """URL of the API, until the block ends."""
    listener = socket.create_server(("127.0.0.1", 0))
    configuration = uvicorn.Config(
        application(database, dict), log_config=None, access_log=False, lifespan="off", timeout_graceful_shutdown=1
    )
    server = uvicorn.Server(configuration)
    thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
    thread.start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}/api/v1"
    finally:
        server.should_exit = True
        thread.join()
        listener.close()
