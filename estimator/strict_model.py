"""Strict models of documents and requests: an unknown field is refused, and a truth value is no number.

Each wrong item and each unknown field is an error of its own, and an error takes more memory and time than the item. A list or
an object that is too long is therefore refused as a whole, before its items are checked.
"""

import functools
import types
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Self

from annotated_types import MaxLen
from pydantic import BaseModel, ConfigDict, ModelWrapValidatorHandler, ValidationError, model_validator
from pydantic.fields import FieldInfo
from pydantic_core import InitErrorDetails, PydanticCustomError, PydanticKnownError

MOST_UNKNOWN = 20
"""Largest number of unknown fields of an object that are named one by one."""


class StrictModel(BaseModel):
    """A part of a document or of a request."""

    model_config = ConfigDict(extra="forbid")

    # One validator for all fields: each one that stands before a field is inspected and built for each of several hundred.
    @model_validator(mode="wrap")
    @classmethod
    def _reject_before_reading(cls, value: Any, validated: ModelWrapValidatorHandler[Self]) -> Self:
        if not isinstance(value, dict):
            return validated(value)
        if len(value) > len(cls.model_fields) + MOST_UNKNOWN:
            raise ValueError(f"{len(value)} fields are given; there are {len(cls.model_fields)}")
        rejected = dict(_rejected(cls, value))
        if not rejected:
            return validated(value)
        try:  # what else is wrong is named in the same round
            validated({name: given for name, given in value.items() if name not in rejected})
        except ValidationError as error:
            others = error.errors(include_url=False)
            if any(not one["loc"] for one in others):  # of the object as a whole, before any field was read
                raise
        else:
            others = []
        raise ValidationError.from_exception_data(cls.__name__, _together(cls, value, rejected, others))


class _TakenValues(NamedTuple):
    """Values that a field takes, as far as the library would not say it."""

    place: int
    longest: int | None
    booleans: bool
    only_booleans: bool


@functools.cache
def _taken_values(model: type[BaseModel]) -> Mapping[str, _TakenValues]:
    """Return what each field takes, by its name and by its alias."""
    found: dict[str, _TakenValues] = {}
    for place, (name, said) in enumerate(model.model_fields.items()):
        taken = _TakenValues(
            place, _most_items(said.annotation, tuple(said.metadata)), _mentions_boolean(said.annotation), _is_boolean(said)
        )
        found |= {name: taken, said.alias or name: taken}
    return found


def _rejected(model: type[BaseModel], value: Mapping[Any, Any]) -> Iterator[tuple[str, str]]:
    """Yield the fields whose values are too long, or truth values where none belongs, or none where one does, with reasons."""
    taken = _taken_values(model)
    for name, given in value.items():
        kind = type(given)
        if name not in taken or (kind is dict and taken[name].longest is None):
            continue
        of = taken[name]
        if of.longest is not None and isinstance(given, list | tuple | dict) and len(given) > of.longest:
            yield name, f"{len(given)} items; at most {of.longest}"
        # The library would take true for 1: a stiffness of 1 N/m where somebody meant to say that there is one.
        elif not of.booleans and _contains_boolean(given):
            yield name, "true and false are no values of this field"
        # Nor is 0 false, or "no": in a document of YAML both are written without quotes.
        elif of.only_booleans and isinstance(given, int | float | str) and kind is not bool:
            yield name, "this field is true or false"


def _together(
    model: type[BaseModel], value: Mapping[str, Any], rejected: Mapping[str, str], others: Sequence[Any]
) -> list[InitErrorDetails]:
    """Return the errors of rejected fields among those of the others, in the order of the fields."""
    taken = _taken_values(model)
    own = [
        InitErrorDetails(type="value_error", loc=(name,), input=value[name], ctx={"error": ValueError(reason)})
        for name, reason in rejected.items()
    ]
    # A rejected field was left out, and is not missing.
    alike = {taken[name].place for name in rejected}
    more = [one for one in others if one["loc"][0] not in taken or taken[one["loc"][0]].place not in alike]

    def place(one: Any) -> int:
        return taken[one["loc"][0]].place if one["loc"][0] in taken else len(taken)

    return sorted([*own, *repeatable(more)], key=place)


def own_words(message: str) -> str:
    """Return the words of an error without what pydantic puts before those of a validator.

    Args:
        message: The message as pydantic lists it.

    Returns:
        The words.
    """
    return message.removeprefix("Value error, ")


def repeatable(errors: Sequence[Any]) -> list[InitErrorDetails]:
    """Return pydantic's errors as they can be raised once more.

    Args:
        errors: Errors as pydantic lists them.

    Returns:
        The same errors.
    """
    return [
        InitErrorDetails(type=_kind(item), loc=item["loc"], input=item["input"], ctx=dict(item.get("ctx") or {}))
        for item in errors
    ]


def _kind(item: Any) -> str | PydanticCustomError:
    """Return pydantic's own kind of an error, or one with its words."""
    context = dict(item.get("ctx") or {})
    try:
        PydanticKnownError(item["type"], context)
    except (KeyError, TypeError, ValueError):
        return PydanticCustomError(item["type"], "{message}", context | {"message": item["msg"]})
    return str(item["type"])


def _contains_boolean(value: Any) -> bool:
    return isinstance(value, bool) or (isinstance(value, list | tuple) and any(map(_contains_boolean, value)))


def fields_beside(model: type[BaseModel], location: Sequence[int | str]) -> list[str]:
    """Return the known fields of the (nested) model in which an error has found an unknown field.

    Args:
        model: The model.
        location: Names, indices and forms from the model down to the unknown field.

    Returns:
        Their names, those of all forms that may stand there.
    """
    models = [model]
    for name in location[:-1]:
        held = [one.model_fields[name].annotation for one in models if isinstance(name, str) and name in one.model_fields]
        models = [one for annotation in held for one in _models_in(annotation)] or models
    return sorted({field.alias or name for one in models for name, field in one.model_fields.items()})


def field_at(model: type[BaseModel], location: Sequence[int | str]) -> FieldInfo | None:
    """Return the field of a (nested) model in which an error lies.

    Args:
        model: The model.
        location: Names, indices and forms from the model down to the field, or to one of its items.

    Returns:
        The innermost field; None where the location leads to none.
    """
    models, found, is_key = [model], None, False
    for name in location:
        if is_key:  # a name that somebody chose, which may also be that of a field
            is_key = False
            continue
        models = [one for one in models if one.__name__ == name] or models  # the form that is told apart by its name
        held = [one.model_fields[name] for one in models if isinstance(name, str) and name in one.model_fields]
        if held:
            found, is_key = held[0], typing.get_origin(held[0].annotation) is dict
            models = [one for field in held for one in _models_in(field.annotation)]
    return found


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [one for argument in typing.get_args(annotation) for one in _models_in(argument)]


def _is_boolean(said: FieldInfo) -> bool:
    """Check whether a field takes nothing but truth values, and perhaps null."""
    return {said.annotation, *typing.get_args(said.annotation)} - {type(None), bool | None} == {bool}


def _mentions_boolean(annotation: Any) -> bool:
    return annotation in (bool, Any) or any(map(_mentions_boolean, typing.get_args(annotation)))


def _most_items(annotation: Any, metadata: tuple[Any, ...]) -> int | None:
    if typing.get_origin(annotation) is typing.Annotated:
        inner, *more = typing.get_args(annotation)
        return _most_items(inner, (*metadata, *more))
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        found = [_most_items(one, metadata) for one in typing.get_args(annotation) if one is not type(None)]
        return None if None in found else max(typing.cast("list[int]", found))
    if typing.get_origin(annotation) not in (list, tuple, dict):
        return None
    said = [one for item in metadata for one in (item.metadata if isinstance(item, FieldInfo) else [item])]
    return min((one.max_length for one in said if isinstance(one, MaxLen)), default=None)
