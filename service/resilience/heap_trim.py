"""Memory that is free goes back to the system: the C library would keep for itself what a backlog or huge messages took."""

import ctypes

_library = ctypes.CDLL(None)
_give_back = getattr(_library, "malloc_trim", None)
_set = getattr(_library, "mallopt", None)
_MOST_HEAPS = -8
"""`M_ARENA_MAX` of the C library's malloc.h."""


def share_one_heap() -> None:
    """Let all threads begun from now on share one heap, where the C library knows how (`mallopt(3)`).

    Of a heap that belongs to a thread nothing gives back what is free at its end: its size is that of the largest moment ever.
    Threads of the interpreter take turns anyway.
    """
    if _set is not None:
        _set(_MOST_HEAPS, 1)


def give_back() -> None:
    """Return free memory to the system, where the C library knows how (`malloc_trim(3)`). Other threads run meanwhile."""
    if _give_back is not None:
        _give_back(0)
