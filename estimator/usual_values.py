"""Usual values of numbers that somebody writes, and the unit that was probably meant where one is far from them.

A field declares its unit in its description, the first words in brackets, and what is usual there, as "usual is …", or as
numbers beside its bounds (`estimator.field_types.Within`). Errors and warnings tell both from here.
"""

import functools
import re
import typing
from collections.abc import Iterator, Mapping
from typing import Any

from msgspec import Struct
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from estimator.field_types import Within
from estimator.units import KILOGRAMS, METRES, RAD_PER_S, RADIANS

UNIT = re.compile(r"\[([^\]]*)\]")
"""Unit in the description of a field; no unit is [-]."""
WHOLE = re.compile(r"\d+")
"""Whole number in a text."""
USUAL = re.compile(r"\busual(?:ly)?\b[^;:]*")
"""Clause of a field's description that says what is usual."""


BOUNDS: Mapping[str, tuple[str, str]] = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "greater than or equal to"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "less than or equal to"),
}
"""Name of the bound in an error, and its words, by the library's kind of the error."""
OIL_DENSITY = 870.0
"""Density of mineral oil, by which a kinematic viscosity becomes a dynamic one [kg/m³]."""
TINY = 1e-20
"""Bound that stands for zero [m, or any unit]."""


class OtherUnit(Struct, frozen=True):
    """A unit in which people think of a quantity.

    Attributes:
        name: Its name.
        factor: One of it in the field's unit [that unit per this one].
        zero: Value in it that is zero in the field's unit [this unit].
    """

    name: str
    factor: float
    zero: float = 0.0

    def converted(self, value: float) -> float:
        """Return a value in this unit in the field's.

        Args:
            value: The value [this unit].

        Returns:
            The value [the field's unit].
        """
        return self.factor * (value - self.zero)


OTHER_UNITS: Mapping[str, tuple[OtherUnit, ...]] = {
    "m": (OtherUnit("mm", METRES["mm"]), OtherUnit("µm", METRES["um"])),
    "kg": (OtherUnit("g", KILOGRAMS["g"]), OtherUnit("t", 1e3)),
    "kg m": (OtherUnit("g mm", 1e-6), OtherUnit("kg mm", 1e-3)),
    "kg m²": (OtherUnit("kg mm²", 1e-6), OtherUnit("kg cm²", 1e-4), OtherUnit("t m²", 1e3)),
    "N": (OtherUnit("kN", 1e3),),
    "N/m": (OtherUnit("N/µm", 1e6),),
    "N s/m": (OtherUnit("N s/mm", 1e3),),
    "N m/rad": (OtherUnit("MN m/rad", 1e6),),
    "N/m²": (OtherUnit("GPa", 1e9), OtherUnit("MPa", 1e6)),
    "kg/m³": (OtherUnit("g/cm³", 1e3),),
    "Pa s": (OtherUnit("mPa s (cP)", 1e-3), OtherUnit("m²/s", OIL_DENSITY)),
    "°C": (OtherUnit("K", 1.0, 273.15), OtherUnit("°F", 1 / 1.8, 32.0)),
    "°": (OtherUnit("rad", 1 / RADIANS["deg"]),),
    "rad": (OtherUnit("mrad", 1e-3), OtherUnit("µrad", 1e-6)),
    "r/min": (OtherUnit("Hz", RAD_PER_S["Hz"] / RAD_PER_S["rpm"]), OtherUnit("rad/s", 1 / RAD_PER_S["rpm"])),
    "-": (OtherUnit("%", 1e-2),),
}
"""Units that are taken for that of a field, by the latter; the likelier ones first."""


def with_unit(value: float, unit: str) -> str:
    """Join a value with its unit.

    Args:
        value: The value [unit].
        unit: Its unit; "-" or nothing where it has none.

    Returns:
        Both.
    """
    return f"{value:g}" if unit in ("", "-") else f"{value:g} {unit}"


def question(value: float, unit: str, usual: tuple[float, float]) -> str:
    """Return the question whether another unit was meant, where that makes a value usual.

    Args:
        value: The value as it was given [unit].
        unit: Unit in which it counts.
        usual: Least and largest usual value [unit].

    Returns:
        The question, beginning with a semicolon; empty where no other unit makes the value usual.
    """
    for one in OTHER_UNITS.get(unit, ()):
        found = one.converted(value)
        if usual[0] <= found <= usual[1]:
            return f"; was {value:g} {one.name} meant, {with_unit(float(f'{found:.3g}'), unit)}?"
    return ""


class Declaration(Struct, frozen=True):
    """Declaration of a field of its numbers.

    Attributes:
        unit: Its unit; "-" for none, empty where the description says nothing.
        usual: Least and largest usual value [unit]; None where that is not declared.
        clause: What is usual, in words; empty where nothing is declared.
    """

    unit: str
    usual: tuple[float, float] | None
    clause: str

    def question(self, value: float) -> str:
        """Return the question whether another unit was meant, as the function of that name does.

        Args:
            value: The value as it was given [unit].

        Returns:
            The question; empty where no other unit makes the value usual.
        """
        return "" if self.usual is None else question(value, self.unit, self.usual)

    def words(self, value: float) -> str:
        """State that a value is not usual.

        Args:
            value: The value as it was given [unit].

        Returns:
            The value with its unit, what is usual, and the unit that was probably meant.
        """
        return f"{with_unit(value, self.unit)}: {self.clause}{self.question(value)}"


@functools.cache
def declarations(model: type[BaseModel]) -> Mapping[str, Declaration]:
    """Return what the fields of a model declare of their numbers.

    Args:
        model: The model.

    Returns:
        Their units and what is usual, by name.
    """
    return {name: declaration(field) for name, field in model.model_fields.items()}


def declaration(field: FieldInfo) -> Declaration:
    """Return what a field declares of its numbers.

    Args:
        field: The field of a model.

    Returns:
        Its unit and what is usual.
    """
    said = field.description or ""
    bracketed, clause = UNIT.search(said), USUAL.search(said)
    unit = bracketed[1] if bracketed else ""
    usual = next((one.usual for one in _bounds([*field.metadata, field.annotation]) if one.usual is not None), None)
    if clause is not None:
        return Declaration(unit, usual, clause[0].strip())
    return Declaration(unit, usual, f"usual is {usual[0]:g} to {with_unit(usual[1], unit)}" if usual else "")


def range_words(error: Any, field: FieldInfo | None) -> str:
    """State that a number passes a bound: with its unit, what is usual, and the unit that was probably meant.

    Args:
        error: The error as pydantic lists it.
        field: The field that it is of; None where that is not known.

    Returns:
        One line; empty for an error of another kind, or of a field that declares neither.
    """
    if error["type"] not in BOUNDS:
        return ""
    name, words = BOUNDS[error["type"]]
    bound, told = float(error["ctx"][name]), declaration(field) if field is not None else Declaration("", None, "")
    bound = 0.0 if 0.0 < bound <= TINY else bound
    if not (told.unit or told.clause):
        return "Input should be greater than 0" if bound == 0.0 and name == "gt" else ""
    value = float(error["input"])
    bound = 0.0 if value <= 0.0 < bound else bound
    said = f"{with_unit(value, told.unit)}: should be {words} {with_unit(bound, told.unit) if bound else 0}"
    return said + (f"; {told.clause}" if told.clause else "") + told.question(value)


def nearest_number(given: Any, expected: str) -> str:
    """Return the question which of the listed numbers was meant.

    Args:
        given: What was given; a text counts by the number in it, such as "VG 33".
        expected: Words with the numbers that there are; texts have none to be near to.

    Returns:
        The question, beginning with a semicolon; empty where there are no numbers.
    """
    said, known = WHOLE.findall(str(given)[:40]), [] if "'" in expected else [int(one) for one in WHOLE.findall(expected)]
    if len(said) != 1 or len(known) < 2:
        return ""
    value = int(said[0])
    return f"; was {min(known, key=lambda one: abs(one - value))} meant?"


def _bounds(declared: Any) -> Iterator[Within]:
    """Yield the bounds among a field's metadata and in its type."""
    for one in declared:
        if isinstance(one, Within):
            yield one
        else:
            yield from _bounds(typing.get_args(one))
