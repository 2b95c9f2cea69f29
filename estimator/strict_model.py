"""Strict models of documents and requests: an unknown field is refused, and a truth value is no number.

Each wrong item and each unknown field is an error of its own, and an error takes more memory and time than the item. A list or
an object that is too long is therefore refused as a whole, before its items are checked.
"""

import functools
import types
import typing
from collections.abc import Sequence
from typing import Any

from annotated_types import MaxLen
from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator, model_validator
from pydantic.fields import FieldInfo

MOST_UNKNOWN = 20
"""Largest number of unknown fields of an object that are named one by one."""


class StrictModel(BaseModel):
    """A part of a document or of a request."""

    model_config = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _reject_many_unknown(cls, value: Any) -> Any:
        if isinstance(value, dict) and len(value) > len(cls.model_fields) + MOST_UNKNOWN:
            raise ValueError(f"{len(value)} fields are given; there are {len(cls.model_fields)}")
        return value

    # One validator for both: each one that stands before a field is inspected and built for each of several hundred fields.
    @field_validator("*", mode="before")
    @classmethod
    def _reject_too_long_and_booleans(cls, value: Any, info: ValidationInfo) -> Any:
        if info.field_name is not None:
            _require_short(cls, info.field_name, value)
            _require_no_foreign_boolean(cls, info.field_name, value)
        return value


def _require_short(model: type[BaseModel], field: str, value: Any) -> None:
    if isinstance(value, list | tuple | dict):
        longest = _longest(model, field)
        if longest is not None and len(value) > longest:
            raise ValueError(f"{len(value)} items; at most {longest}")


def _require_no_foreign_boolean(model: type[BaseModel], field: str, value: Any) -> None:
    # The library would take true for 1: a stiffness of 1 N/m where somebody meant to say that there is one.
    if _contains_boolean(value) and not _accepts_boolean(model, field):
        raise ValueError("true and false are no values of this field")
    # Nor is 0 false, or "no": in a document of YAML both are written without quotes.
    if isinstance(value, int | float | str) and not isinstance(value, bool) and _requires_boolean(model, field):
        raise ValueError("this field is true or false")


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
    return sorted({name for one in models for name in one.model_fields})


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [one for argument in typing.get_args(annotation) for one in _models_in(argument)]


@functools.cache
def _accepts_boolean(model: type[BaseModel], field: str) -> bool:
    return _mentions_boolean(model.model_fields[field].annotation)


@functools.cache
def _requires_boolean(model: type[BaseModel], field: str) -> bool:
    annotation = model.model_fields[field].annotation
    return {annotation, *typing.get_args(annotation)} - {type(None), bool | None} == {bool}


def _mentions_boolean(annotation: Any) -> bool:
    return annotation in (bool, Any) or any(map(_mentions_boolean, typing.get_args(annotation)))


@functools.cache
def _longest(model: type[BaseModel], field: str) -> int | None:
    """Return the most items of a field that holds several; None where they are not bounded."""
    said = model.model_fields[field]
    return _most_items(said.annotation, tuple(said.metadata))


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
