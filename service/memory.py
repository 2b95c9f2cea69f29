"""Memory that is free goes back to the system: the C library would keep for itself what a backlog or huge messages took."""

import ctypes

_give_back = getattr(ctypes.CDLL(None), "malloc_trim", None)


def give_back() -> None:
    """Return free memory to the system, where the C library knows how (`malloc_trim(3)`). Other threads run meanwhile."""
    if _give_back is not None:
        _give_back(0)
