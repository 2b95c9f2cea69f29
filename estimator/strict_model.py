"""Strict models of documents and requests: an unknown field is refused, and a truth value is no number."""

import functools
import typing
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationInfo, field_validator


class StrictModel(BaseModel):
    """A part of a document or of a request."""

    model_config = ConfigDict(extra="forbid")

    @field_validator("*", mode="before")
    @classmethod
    def _reject_booleans(cls, value: Any, info: ValidationInfo) -> Any:
        # The library would take true for 1: a stiffness of 1 N/m where somebody meant to say that there is one.
        if info.field_name is not None and _contains_boolean(value) and not _accepts_boolean(cls, info.field_name):
            raise ValueError("true and false are no values of this field")
        # Nor is 0 false, or "no": in a document of YAML both are written without quotes.
        other = isinstance(value, int | float | str) and not isinstance(value, bool)
        if other and info.field_name is not None and _requires_boolean(cls, info.field_name):
            raise ValueError("this field is true or false")
        return value


def _contains_boolean(value: Any) -> bool:
    return isinstance(value, bool) or (isinstance(value, list | tuple) and any(map(_contains_boolean, value)))


@functools.cache
def _accepts_boolean(model: type[BaseModel], field: str) -> bool:
    return _mentions_boolean(model.model_fields[field].annotation)


@functools.cache
def _requires_boolean(model: type[BaseModel], field: str) -> bool:
    annotation = model.model_fields[field].annotation
    return {annotation, *typing.get_args(annotation)} - {type(None), bool | None} == {bool}


def _mentions_boolean(annotation: Any) -> bool:
    return annotation in (bool, Any) or any(map(_mentions_boolean, typing.get_args(annotation)))
