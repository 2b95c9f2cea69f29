"""Returning free memory to the system: the C library would keep what a backlog or huge messages took."""

import ctypes

_library = ctypes.CDLL(None)
_malloc_trim = getattr(_library, "malloc_trim", None)
_set = getattr(_library, "mallopt", None)
_M_ARENA_MAX = -8
"""`M_ARENA_MAX` of the C library's malloc.h."""


def share_one_heap() -> None:
    """Let all threads started from now on share one heap, if the C library supports it (`mallopt(3)`).

    Free memory at the end of a thread's own heap is never returned: the heap keeps the size of its largest moment. The
    interpreter's threads take turns anyway.
    """
    if _set is not None:
        _set(_M_ARENA_MAX, 1)


def release_free_memory() -> None:
    """Return free memory to the system, if the C library supports it (`malloc_trim(3)`). Other threads run meanwhile."""
    if _malloc_trim is not None:
        _malloc_trim(0)
