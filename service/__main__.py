"""`python -m service` is the command `rundown`."""

import gc


def main() -> None:
    """Entry point."""
    # Nothing of what is loaded is garbage: looking for some takes a good part of the start.
    gc.disable()
    from service.cli import app

    gc.freeze()
    gc.enable()
    app()


if __name__ == "__main__":
    main()
