"""Reads machine documents and other YAML or JSON files, with errors that a person can act on."""

from collections.abc import Collection, Mapping
from itertools import chain
from pathlib import Path
from typing import Any

from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, Machine
from formats.files.like_named_files import like_named
from formats.files.table_files import WrongTableFile, with_table_columns


class UnreadableFile(ValueError):
    """A file cannot be read or has the wrong content; the message names the file."""


LARGEST_BYTES = 16 * 2**20
"""Largest file [B]; the service takes documents of two megabytes."""
MOST_VALUES = 1_000_000
"""Most values of a file, those that stand for others counted with all in them."""


def read_yaml(path: Path) -> Any:
    """Return the content of a YAML or JSON file. Raises UnreadableFile."""
    import yaml  # not needed by those who make machines in a program

    from formats.files import bounded_yaml

    try:
        if path.stat().st_size > LARGEST_BYTES:
            raise UnreadableFile(f"{path} has {path.stat().st_size} bytes; at most {LARGEST_BYTES}")
        content = bounded_yaml.load(path.read_text(encoding="utf-8"))
        values = _values_in(content, {}, set())
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        right = ": indent with spaces, not with tabs" if "'\\t'" in str(error.problem) else ""
        raise UnreadableFile(f"{path}{line} is neither YAML nor JSON: {error.problem}{right}") from error
    except OSError as error:
        raise UnreadableFile(f"{path}: {error.strerror}{like_named(path)}") from error
    except RecursionError as error:
        raise UnreadableFile(f"{path}: lists and fields lie too deep in each other") from error
    except UnreadableFile:
        raise
    except bounded_yaml.TooManyValues as error:
        most = bounded_yaml.MOST_WRITTEN
        raise UnreadableFile(f"{path}, {error}: more values are written than the {most} a file may have") from error
    except bounded_yaml.WrittenTwice as error:
        raise UnreadableFile(f"{path}, {error}: keep one of them") from error
    except _Circle as error:
        raise UnreadableFile(f"{path}: a part of it stands for something in which it lies itself") from error
    # The library lets errors of Python pass: of dates, of numbers, of tags.
    except (yaml.YAMLError, ValueError, LookupError, ArithmeticError, TypeError, AttributeError) as error:
        raise UnreadableFile(f"{path} is neither YAML nor JSON: {error}") from error
    if values > MOST_VALUES:
        raise UnreadableFile(f"{path}: {values:.3g} values, as some stand for many others; at most {MOST_VALUES}")
    return content


class _Circle(Exception):
    """A value lies in itself."""


def _values_in(value: Any, known: dict[int, int], around: set[int]) -> int:
    """Count the values that lie in one, itself included. known: counts by object. Raises _Circle, RecursionError."""
    if not isinstance(value, Collection) or isinstance(value, (str, bytes)):
        return 1
    place = id(value)
    if place in around:
        raise _Circle
    if place not in known:
        around.add(place)
        inner = chain(value, value.values()) if isinstance(value, Mapping) else value
        known[place] = 1 + sum(_values_in(one, known, around) for one in inner)
        around.discard(place)
    return known[place]


def read_machine(path: Path) -> Machine:
    """Read the machine document in a file, with the tables in CSV files that it names beside it.

    Raises UnreadableFile, which names every wrong field, also for an oversized one.
    """
    if path.suffix.lower() == ".csv" and path.is_file():
        raise UnreadableFile(f"{path} is a table and not a machine document: the document comes first, such as pump.yaml")
    try:
        return accepted_machine(with_table_columns(read_yaml(path), path.parent))
    except WrongTableFile as error:
        raise UnreadableFile(f"{path}: {error}") from error
    except DocumentError as error:
        raise UnreadableFile(f"{path} is not a machine document:{error.listed}") from error
