"""Reads machine documents and other YAML or JSON files, with errors that a person can act on."""

from pathlib import Path
from typing import Any

from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, Machine
from formats.files.table_files import WrongTableFile, with_table_columns


class UnreadableFile(ValueError):
    """A file cannot be read or has the wrong content; the message names the file."""


def read_yaml(path: Path) -> Any:
    """Return the content of a YAML or JSON file. Raises UnreadableFile."""
    import yaml  # not needed by those who make machines in a program

    try:
        return yaml.safe_load(path.read_text(encoding="utf-8"))
    except yaml.MarkedYAMLError as error:
        line = "" if error.problem_mark is None else f", line {error.problem_mark.line + 1}"
        raise UnreadableFile(f"{path}{line} is neither YAML nor JSON: {error.problem}") from error
    except OSError as error:
        raise UnreadableFile(f"{path}: {error.strerror}") from error
    except (UnicodeDecodeError, yaml.YAMLError) as error:
        raise UnreadableFile(f"{path} is neither YAML nor JSON: {error}") from error


def read_machine(path: Path) -> Machine:
    """Read the machine document in a file, with the tables in CSV files that it names beside it.

    Raises UnreadableFile, which names every wrong field, also for an oversized one.
    """
    try:
        return accepted_machine(with_table_columns(read_yaml(path), path.parent))
    except WrongTableFile as error:
        raise UnreadableFile(f"{path}: {error}") from error
    except DocumentError as error:
        raise UnreadableFile(f"{path} is not a machine document:{error.listed}") from error
