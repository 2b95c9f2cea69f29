"""`python -m service` is the command `rundown`."""

import gc
import os
import sys

SERVICE_ONLY = (
    "aiohttp",
    "alembic",
    "fastapi",
    "fastapi_offline",
    "httpx",
    "jwt",
    "prometheus_client",
    "pydantic_settings",
    "sqlalchemy",
    "threadpoolctl",
    "typer",
    "uvicorn",
    "zenoh",
)
"""Modules that the service needs and the library does not."""


def main() -> None:
    """Start the command; say in one line where only the library is installed."""
    # Before numpy is loaded: the matrices are small, and more threads would only take the processors from other work.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Nothing of what is loaded is garbage: looking for some takes a good part of the start.
    gc.disable()
    try:
        from service.commands.app import app

        gc.freeze()
        gc.enable()
        app()
    except ModuleNotFoundError as error:
        package = str(error.name).partition(".")[0]
        if package not in SERVICE_ONLY:
            raise
        sys.exit(
            f"rundown: {package} is not installed. The library works without it (import rotorundown); "
            "the service and its commands need: pip install 'rotorundown[service]'"
        )


if __name__ == "__main__":
    main()
