"""Contradictions of a document that has wrong fields: those between the parts that are right, told in the same round.

Without it an unknown shaft would only be named once every number is right. A reference to a part that is there, but wrong
itself, is no contradiction.
"""

import re
from collections.abc import Iterator, Mapping
from typing import Any, cast

from msgspec import Struct, field
from pydantic import BaseModel, ValidationError
from pydantic_core import InitErrorDetails

from estimator.machine.consistency import Train, naming_problems

MOST_PARTS = 200
"""Longest list of parts that is looked through."""


NAME = re.compile(r"[A-Za-z0-9_-]{1,64}")
"""Form of a name: `estimator.field_types.Identifier`."""
REFERENCES: Mapping[str, frozenset[str]] = {
    "materials": frozenset({"material"}),
    "shafts": frozenset({"shaft", "station", "driver", "driven"}),
    "bearings": frozenset({"bearing", "mounted_on"}),
    "couplings": frozenset({"coupling"}),
    "conditions": frozenset({"scaled_by", "temperature_from"}),
}
"""Fields that name a part of each list, which nobody can judge while one of the list has no name."""


class _PartialTrain(Struct, eq=False):
    """The parts of a train that are right, by the names of their lists, with their places in these."""

    parts: dict[str, list[Any]] = field(default_factory=dict)
    places: dict[str, list[int]] = field(default_factory=dict)
    single: dict[str, Any] = field(default_factory=dict)

    def __getattr__(self, name: str) -> Any:
        if name in self.single:
            return self.single[name]
        if name in self.parts:
            return self.parts[name]
        raise AttributeError(name)


def further_problems(
    document: Any, lists: Mapping[str, type[BaseModel]], single: Mapping[str, type[BaseModel]], mappings: Mapping[str, Any]
) -> list[InitErrorDetails]:
    """Find the contradictions between the right parts of a document that has wrong fields.

    Args:
        document: The decoded document.
        lists: Model of the parts of each list, by the list's name.
        single: Model of each field that is one object, by the field's name.
        mappings: Model of the values of each field that is a mapping, by the field's name.

    Returns:
        The contradictions with their places in the document.
    """
    if not isinstance(document, dict):
        return []
    train = _PartialTrain()
    for name, model in lists.items():
        given = document.get(name, ())
        given = given if isinstance(given, list | tuple) and len(given) <= MOST_PARTS else ()
        right = [(place, part) for place, one in enumerate(given) if (part := _part(model, one)) is not None]
        train.parts[name] = [part for _, part in right]
        train.places[name] = [place for place, _ in right]
    for name, model in single.items():
        train.single[name] = _part(model, document.get(name, {})) or model.model_construct()
    for name in mappings:
        given = document.get(name, {})
        train.single[name] = given if isinstance(given, dict) else {}
    named = frozenset(_names(document))
    open_fields = {field for name in REFERENCES if not _are_named(document.get(name), name) for field in REFERENCES[name]}
    return [
        _moved(one, train)
        for one in _without_failing(naming_problems(cast("Train", train)))
        if one["loc"][-1] not in open_fields and (one["input"] not in named or one["loc"][-1] in ("id", "name"))
    ]


def _part(model: type[BaseModel], value: Any) -> BaseModel | None:
    try:
        return model.model_validate(value)
    except ValidationError:
        return None


def _are_named(given: Any, name: str) -> bool:
    """Check whether all parts of a list, or all keys of a mapping, have names; a list that may be left out has."""
    if isinstance(given, dict):
        return bool(given)
    if given is None:
        return name in ("couplings", "conditions")
    key = "name" if name == "conditions" else "id"
    return (
        isinstance(given, list | tuple)
        and all(isinstance(one, dict) and isinstance(said := one.get(key), str) and NAME.fullmatch(said) for one in given)
        and (bool(given) or name in ("couplings", "conditions"))
    )


def _names(document: Mapping[str, Any]) -> Iterator[Any]:
    """Yield the ids and names that the parts of a document have, right or wrong."""
    for value in document.values():
        if isinstance(value, dict):
            yield from (name for name in value if isinstance(name, str))
        for one in value if isinstance(value, list | tuple) else ():
            if isinstance(one, dict):
                yield from (said for name in ("id", "name") if isinstance(said := one.get(name), str))


def _without_failing(found: Iterator[InitErrorDetails]) -> Iterator[InitErrorDetails]:
    """Yield contradictions up to a check that needs what is not there."""
    try:
        yield from found
    except (AttributeError, KeyError, TypeError):
        return


def _moved(one: InitErrorDetails, train: _PartialTrain) -> InitErrorDetails:
    """Return a contradiction with the place of its part in the whole document."""
    name, place, *rest = one["loc"]
    if isinstance(name, str) and name in train.places and isinstance(place, int):
        one["loc"] = (name, train.places[name][place], *rest)
    return one
