"""`python -m service` is the command `rundown`."""

import gc
import io
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
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):  # a terminal's or file's letters may be fewer than χ² and µm need
            stream.reconfigure(errors="replace")
    _require_own_packages()
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


def _require_own_packages() -> None:
    """End in one line where a file of the user's hides a package of Rundown: the library's import looks for that."""
    try:
        import rotorundown  # noqa: F401
    except ImportError as error:
        sys.exit(f"rundown: {error}")


if __name__ == "__main__":
    main()
