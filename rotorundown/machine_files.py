"""Reads machine documents, from files or from what a program has made."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from estimator.errors import Invalid
from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, Machine, parse_machine
from formats.files.document_files import UnreadableFile
from formats.files.document_files import read_machine as read_machine_file
from rotorundown.environment.example_machines import found_example, other_examples


class WrongMachine(Invalid):
    """Raised for something that describes no machine; the message names every wrong field."""


def read_machine(source: str | Path | Mapping[str, Any] | Machine) -> Machine:
    """Return the machine that a document describes.

    Args:
        source: Path of a YAML or JSON file, or the content of one as a mapping; or a machine, which is checked. Where there is
            no such file, `examples/NAME.yaml` is the example machine that comes with the library.

    Returns:
        The machine.

    Raises:
        WrongMachine: The file cannot be read, or something in it is wrong; the message names each wrong field.
    """
    if isinstance(source, Machine):
        return checked_machine(source)
    if isinstance(source, str) and "\n" in source:
        raise WrongMachine("this is the text of a document: give the path of its file, or what yaml.safe_load makes of it")
    if hasattr(source, "read"):
        raise WrongMachine(f"a machine is a document's path, not an opened file ({type(source).__name__}): give its path")
    if not isinstance(source, str | Path | Mapping):
        raise WrongMachine(f"a machine is a document's path or its fields by name, not {type(source).__name__}")
    try:
        if isinstance(source, Mapping):
            return accepted_machine(dict(source))
        return read_machine_file(found_example(Path(source)))
    except UnreadableFile as error:
        others = "" if isinstance(source, Mapping) else other_examples(found_example(Path(source)))
        raise WrongMachine(f"{error}{others}") from None
    except DocumentError as error:
        raise WrongMachine(f"this is not a machine document:{error.listed}") from None


def checked_machine(machine: Machine) -> Machine:
    """Return a machine as it is: a copy may have been changed into what no document can say, and copying checks nothing.

    Args:
        machine: The machine.

    Returns:
        The machine.

    Raises:
        WrongMachine: Something in it is wrong; the message names each wrong field.
    """
    try:
        parse_machine(machine.model_dump(warnings="none"))
    except DocumentError as error:
        raise WrongMachine(f"this is no machine:{error.listed}") from None
    return machine
