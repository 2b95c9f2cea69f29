"""Bearings of a machine document whose coefficients follow from their oil films, each with its film and its form."""

from collections.abc import Iterable, Sequence

from msgspec import Struct

from estimator.bearings.journal import JournalForm
from estimator.machine.films import JournalFilm
from estimator.machine.parts import Bearing


class BearingOnFilm(Struct, frozen=True):
    """A bearing whose coefficients follow from its oil film.

    Attributes:
        number: Its number among the document's bearings, from 0.
        id: Its id.
        film: What the document says of its film.
        form: How far that may be off.
    """

    number: int
    id: str
    film: JournalFilm
    form: JournalForm


def bearings_on_films(bearings: Iterable[Bearing]) -> tuple[BearingOnFilm, ...]:
    """Return those of a document's bearings whose coefficients follow from their oil films.

    Args:
        bearings: All bearings, in the document's order.

    Returns:
        Those on films; others beside them are supports of a stiffness of their own.
    """
    return tuple(
        BearingOnFilm(number, one.id, one.film, one.speed_dependence)
        for number, one in enumerate(bearings)
        if one.film is not None and isinstance(one.speed_dependence, JournalForm)
    )


def loaded_films(bearings: Sequence[Bearing]) -> tuple[JournalFilm | None, ...]:
    """Return the film of each bearing that the train's loads follow from.

    Args:
        bearings: All bearings, in the document's order.

    Returns:
        What the document says of each film; None of bearings with coefficients of their own. Where no bearing's coefficients
        follow from its film, all films count that there are.
    """
    followed = {one.number for one in bearings_on_films(bearings)}
    return tuple(one.film if number in followed or not followed else None for number, one in enumerate(bearings))
