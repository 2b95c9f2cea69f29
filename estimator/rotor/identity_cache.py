"""Cache of results by the identity of their arguments: machines and rotors never change, so that each is its own key.

Numbers are told apart by their value.
"""

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import TypeVar, TypeVarTuple

from estimator.machine.document import Machine

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
    """Arguments that equal others where each is the very same object or number; what they are parts of does not count."""

    def __init__(self, arguments: tuple[object, ...], of: object = None) -> None:
        self.arguments = arguments  # held, so that no other object can take its place in memory
        self.of = of

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


def cached_without_probes(function: Callable[[Machine], Computed]) -> Callable[[Machine], Computed]:
    """Cache what follows from a machine whatever its probes are, as `cached_for_runs` does.

    A machine and its copy with other probes, of which all else is the very same, have one result.

    Args:
        function: Function of a machine, whose results are small.

    Returns:
        The cached function.
    """
    parts = [name for name in Machine.model_fields if name != "probes"]

    @lru_cache(maxsize=RUNS)
    def known(key: _IdentityKey) -> Computed:
        return function(key.of)  # type: ignore[arg-type]

    @wraps(function)
    def answered(machine: Machine) -> Computed:
        return known(_IdentityKey(tuple(getattr(machine, name) for name in parts), machine))

    return answered


def _cached(function: Callable[[*Arguments], Computed], size: int) -> Callable[[*Arguments], Computed]:
    @lru_cache(maxsize=size)
    def known(key: _IdentityKey) -> Computed:
        return function(*key.arguments)  # type: ignore[arg-type]

    @wraps(function)
    def answered(*arguments: *Arguments) -> Computed:
        return known(_IdentityKey(arguments))

    return answered
