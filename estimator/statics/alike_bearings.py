"""Films of all bearings of a train at several speeds: those of one geometry at once, which takes little longer than one."""

from collections.abc import Sequence
from dataclasses import fields

import numpy as np

from estimator.arrays import Bools, Floats
from estimator.films.dimensional_film import FilmScale, film_in_si
from estimator.films.film import FilmCoefficients
from estimator.statics.journal_bearing import JournalBearing, turned
from estimator.statics.linear_support import LinearSupport

Bearings = Sequence[JournalBearing | LinearSupport]


def films_at(bearings: Bearings, position: Floats, *, speed: Floats) -> tuple[FilmCoefficients, ...]:
    """Compute the film at each journal, or what carries it in place of one.

    Source: as `FilmCoefficients`: J. W. Lund, J. Tribol. 109 (1987) 37.

    Args:
        bearings: The n bearings.
        position: Positions (S, n, 2) of the journals relative to their bearings' centres [m].
        speed: Spin speeds (S,), without sign [rad/s].

    Returns:
        The n films at S positions.

    Raises:
        OutsideFilm: A film is thinner somewhere than it is known.
    """
    found = {number: one.at(position[:, number], speed=speed) for number, one in _supports(bearings).items()}
    for numbers, alike in _alike(bearings):
        scale = _scale(alike, speed)
        place = alike[0].mirrored(position[:, numbers]) / scale.clearance[..., None]
        whole = turned(film_in_si(alike[0].film.at(place), scale), alike[0].sign)
        found |= {number: whole.one_of((slice(None), column)) for column, number in enumerate(numbers)}
    return tuple(found[number] for number in range(len(bearings)))


def covered(bearings: Bearings, position: Floats) -> Bools:
    """Return where all films are known.

    Source: as `Film.covers`: tables end at a film of three hundredths of the clearance.

    Args:
        bearings: The n bearings.
        position: Positions (S, n, 2) of the journals relative to their bearings' centres [m].

    Returns:
        Whether they are (S,).
    """
    known = np.ones(len(position), dtype=bool)
    for numbers, alike in _alike(bearings):
        clearance = np.array([one.clearance for one in alike])
        known &= alike[0].film.covers(alike[0].mirrored(position[:, numbers]) / clearance[:, None]).all(axis=-1)
    return known


def _supports(bearings: Bearings) -> dict[int, LinearSupport]:
    return {number: one for number, one in enumerate(bearings) if isinstance(one, LinearSupport)}


def _alike(bearings: Bearings) -> list[tuple[list[int], list[JournalBearing]]]:
    """Return the bearings on films, with their numbers, in groups that have one film and one sense of rotation."""
    groups: dict[tuple[int, int], tuple[list[int], list[JournalBearing]]] = {}
    for number, one in enumerate(bearings):
        if isinstance(one, JournalBearing):
            numbers, alike = groups.setdefault((id(one.film), one.direction), ([], []))
            numbers.append(number)
            alike.append(one)
    return list(groups.values())


def _scale(alike: Sequence[JournalBearing], speed: Floats) -> FilmScale:
    """Return the units (S, k) of the films of k bearings."""
    scales = [one.scale(speed) for one in alike]
    return FilmScale(*(np.stack([getattr(one, field.name) for one in scales], axis=-1) for field in fields(FilmScale)))
