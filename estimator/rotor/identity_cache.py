"""Cache of results by the identity of their arguments: machines and rotors never change, so that each is its own key.

Numbers are told apart by their value.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import TypeVar, TypeVarTuple

CACHE_SIZE = 6
"""Number of results cached of each function: an identification needs its machine, with exact probes, scaled, and turned the
other way.
"""
RUNS = 24
"""Number of results cached of what is small and asked of a machine under the conditions of each run: an assessment compares a
baseline and the newest runs.
"""

Arguments = TypeVarTuple("Arguments")
Computed = TypeVar("Computed")


class _IdentityKey:
    """Arguments that equal others where each is the very same object or number."""

    def __init__(self, arguments: tuple[object, ...]) -> None:
        self.arguments = arguments  # held, so that no other object can take its place in memory

    def __hash__(self) -> int:
        return hash(tuple(one if isinstance(one, float) else id(one) for one in self.arguments))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _IdentityKey) and all(
            one is another or (isinstance(one, float) and one == another)
            for one, another in zip(self.arguments, other.arguments, strict=True)
        )


def cached_by_identity(function: Callable[[*Arguments], Computed]) -> Callable[[*Arguments], Computed]:
    """Cache a function's results by the identity of its arguments; neither they nor the result may be changed.

    Args:
        function: Function of objects and numbers.

    Returns:
        The cached function.
    """
    return _cached(function, CACHE_SIZE)


def cached_for_runs(function: Callable[[*Arguments], Computed]) -> Callable[[*Arguments], Computed]:
    """Cache a function's results as `cached_by_identity` does, those of the machines of as many runs as are compared.

    Args:
        function: Function of objects and numbers, whose results are small.

    Returns:
        The cached function.
    """
    return _cached(function, RUNS)


def _cached(function: Callable[[*Arguments], Computed], size: int) -> Callable[[*Arguments], Computed]:
    @lru_cache(maxsize=size)
    def known(key: _IdentityKey) -> Computed:
        return function(*key.arguments)  # type: ignore[arg-type]

    @wraps(function)
    def answered(*arguments: *Arguments) -> Computed:
        return known(_IdentityKey(arguments))

    return answered
