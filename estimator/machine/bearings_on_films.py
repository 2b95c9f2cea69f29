"""Bearings of a machine document whose coefficients follow from their oil films, each with its film and its form."""

from collections.abc import Iterable

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
        bearings: All bearings, in the document's order; of a consistent document all are on films, or none is.

    Returns:
        Those on films, without any of which the document does not describe the film.
    """
    return tuple(
        BearingOnFilm(number, one.id, one.film, one.speed_dependence)
        for number, one in enumerate(bearings)
        if one.film is not None and isinstance(one.speed_dependence, JournalForm)
    )
