"""Results of commands as JSON, for programs: SI units unless a name says another; what is no number is null."""

import dataclasses
import json
import math
from collections.abc import Mapping
from contextvars import ContextVar
from datetime import datetime
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer
from msgspec import Struct, structs
from pydantic import BaseModel

from service.commands.terminal import print_text

_awaited: ContextVar[bool] = ContextVar("_awaited", default=False)
"""True where the running command was asked for JSON and has printed none yet."""


def _note(asked: bool) -> bool:
    _awaited.set(asked)
    return asked


# Eager: what is wrong with a file's name is told while the command line is being read.
JsonOption = Annotated[
    bool, typer.Option("--json", callback=_note, is_eager=True, help="print the result as JSON, for a program")
]


def print_json(content: Any) -> None:
    """Print a result as JSON on the standard output; letters beyond ASCII are escaped."""
    _awaited.set(False)
    print_text(json.dumps(json_value(content), indent=1, allow_nan=False))


def is_awaited() -> bool:
    """Check whether the running command was asked for JSON and has printed none yet."""
    return _awaited.get()


def json_value(value: Any) -> Any:
    """Return a value as JSON has it: dataclasses and structs as objects, arrays as lists, complex numbers as two parts."""
    if isinstance(value, BaseModel):
        return value.model_dump(mode="json", exclude_none=True)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {one.name: json_value(getattr(value, one.name)) for one in dataclasses.fields(value)}
    if isinstance(value, Struct):
        return {name: json_value(one) for name, one in structs.asdict(value).items()}
    if isinstance(value, Mapping):
        return {str(name): json_value(one) for name, one in value.items()}
    if hasattr(value, "tolist"):  # of numpy, which most commands do without
        return json_value(value.tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [json_value(one) for one in (sorted(value) if isinstance(value, set | frozenset) else value)]
    if isinstance(value, complex):
        return {"real": json_value(value.real), "imaginary": json_value(value.imag)}
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Enum):
        return value.name
    return str(value) if isinstance(value, Path | datetime) else value
