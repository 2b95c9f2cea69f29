"""Coordinates that the causes of a diagnosis have moved, as their findings declare them."""

from collections.abc import Iterable

from estimator.alignment.freed_coordinates import MovingCause
from estimator.diagnosis.finding_kinds import FINDING_KINDS

_MOVES = {one.kind: one.moves for one in FINDING_KINDS if one.moves is not None}


def moving_causes(named: Iterable[tuple[str, str]]) -> tuple[MovingCause, ...]:
    """Return what named causes move of a train on oil films.

    Args:
        named: Kind and element of each cause; kinds of another release move nothing.

    Returns:
        Element of each cause that moves something, and what it moves.
    """
    return tuple((element, _MOVES[kind]) for kind, element in named if kind in _MOVES)
