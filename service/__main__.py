"""`python -m service` is the command `rundown`."""

import gc
import os


def main() -> None:
    """Start the command."""
    # Before numpy is loaded: the matrices are small, and more threads would only take the processors from other work.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Nothing of what is loaded is garbage: looking for some takes a good part of the start.
    gc.disable()
    from service.commands.app import app

    gc.freeze()
    gc.enable()
    app()


if __name__ == "__main__":
    main()
