"""Memory that is free goes back to the system: the C library would keep for itself what a backlog or huge messages took."""

import ctypes

_library = ctypes.CDLL(None)
_malloc_trim = getattr(_library, "malloc_trim", None)
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


def release_free_memory() -> None:
    """Return free memory to the system, where the C library knows how (`malloc_trim(3)`). Other threads run meanwhile."""
    if _malloc_trim is not None:
        _malloc_trim(0)
