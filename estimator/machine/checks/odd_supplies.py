"""Oil supplies of films that are probably a mistake: one has one oil, and is named alike by all that it feeds."""

import re
from collections.abc import Iterator, Mapping, Sequence

from estimator.close_matches import close_names
from estimator.machine.document import Machine
from estimator.machine.films import Oil

UNLIKE = 2.0
"""Ratio of viscosities in films of one supply above which they are doubted [-]: 20 K make it."""
NUMBERED = re.compile(r"([-_]?[0-9]+|[-_][A-Za-z]{1,3}|[A-Z])$")
"""End of a name by which those of several supplies differ on purpose, such as `oil_2`."""


def odd_supplies(machine: Machine) -> Iterator[tuple[str, str]]:
    """Find films of one supply with unlike oils, and supplies that only a misspelt name makes one's own.

    Args:
        machine: The machine.

    Yields:
        The field, and a sentence about it.
    """
    fed: dict[str, list[int]] = {}
    for number, bearing in enumerate(machine.bearings):
        if bearing.film is not None and bearing.film.oil.supply is not None:
            fed.setdefault(bearing.film.oil.supply, []).append(number)
    for supply, numbers in fed.items():
        yield from _unlike_oils(machine, supply, numbers)
    yield from _misspelt(machine, fed)


def _unlike_oils(machine: Machine, supply: str, numbers: Sequence[int]) -> Iterator[tuple[str, str]]:
    """Yield oils that are not those of the first film of their supply that says as much."""
    oils = [(number, _oil(machine, number)) for number in numbers]
    graded = [(number, oil.iso_vg) for number, oil in oils if oil.iso_vg is not None]
    for number, grade in graded[1:]:
        if grade != graded[0][1]:
            first = machine.bearings[graded[0][0]].id
            words = f"ISO VG {grade}, but bearing {first} of the same supply '{supply}' has ISO VG {graded[0][1]}"
            yield f"bearings[{number}].film.oil.iso_vg", f"{words}: one supply has one oil"
    viscous = [(number, oil.viscosity) for number, oil in oils if oil.viscosity is not None]
    for number, viscosity in viscous[1:]:
        known = viscous[0][1]
        if max(viscosity / known, known / viscosity) > UNLIKE:
            first = machine.bearings[viscous[0][0]].id
            words = f"{viscosity:g} Pa s, but bearing {first} of the same supply '{supply}' has {known:g} Pa s"
            yield f"bearings[{number}].film.oil.viscosity", f"{words}: one supply has one oil, usual is up to twice as much"


def _misspelt(machine: Machine, fed: Mapping[str, Sequence[int]]) -> Iterator[tuple[str, str]]:
    """Yield supplies of one film alone with a name like that of another supply."""
    for supply, numbers in fed.items():
        stem = NUMBERED.sub("", supply)
        others = [one for one in fed if one != supply and NUMBERED.sub("", one) != stem and len(fed[one]) >= len(numbers)]
        alike = close_names(supply, others)
        if len(numbers) == 1 and alike:
            fellows = ", ".join(machine.bearings[one].id for one in fed[alike[0]])
            words = f"'{supply}' is the supply of this bearing alone, '{alike[0]}' that of {fellows}"
            yield f"bearings[{numbers[0]}].film.oil.supply", f"{words}: is it the same one, was '{alike[0]}' meant?"


def _oil(machine: Machine, number: int) -> Oil:
    film = machine.bearings[number].film
    assert film is not None  # as those that are asked for have one
    return film.oil
