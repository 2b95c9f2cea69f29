"""First steps with a machine of one's own: a document to begin with, and a look at documents and recordings."""

import re
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.commands.exit import fail
from service.commands.file_arguments import MachineFile, named_files
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, print_text, working

if TYPE_CHECKING:
    from estimator.machine.document import Machine

TEMPLATE = "first_machine.yaml"
PLACEHOLDER = "MACHINE"


def init(
    file: Annotated[Path, typer.Argument(help="document to write; its name becomes the machine's id")],
) -> None:
    """Write a commented machine document to begin with: a motor and a pump, each on two bearings."""
    name = file.stem
    if not re.fullmatch(r"[A-Za-z0-9_-]{1,64}", name):
        fail(f"'{name}' is no id: name the file with letters, digits, '_' and '-', up to 64, such as pump-12.yaml")
    if file.suffix.lower() not in ("", ".yaml", ".yml"):
        fail(f"{file}: the document is YAML, with comments; name it {file.with_suffix('.yaml').name}")
    text = files("service.commands").joinpath(TEMPLATE).read_text(encoding="utf-8")
    try:
        with file.open("x", encoding="utf-8") as written:
            written.write(re.sub(rf"\b{PLACEHOLDER}\b", name, text))
    except FileExistsError:
        fail(f"{file} is there already: name another file, or delete it first")
    except OSError as error:
        fail(f"{file}: {error.strerror}")
    print_line(f"{file} is written; edit it, then: rundown check {file}")


def check(
    machine: MachineFile,
    runs: Annotated[
        list[Path] | None, typer.Argument(help="recorded runs of this machine, as for replay", callback=named_files)
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Check a machine document, and recorded runs against it: what they hold, and what is probably a mistake.

    A train that would whirl, or whose journals would touch, within its speed range is warned of; on oil films that takes
    some seconds. Ends with status 1 where something is wrong; a warning is none.
    """
    from rotorundown.checks import all_warnings
    from rotorundown.machine_files import WrongMachine, read_machine

    try:
        described = read_machine(machine)
    except WrongMachine as error:
        fail(str(error))
    with working("looking whether the films carry and the train would whirl"):
        warnings = all_warnings(described)
    for warning in warnings:
        print_line(f"warning: {warning}", err=True)
    parts = (
        (described.shafts, "shaft"),
        (described.discs, "disc"),
        (described.bearings, "bearing"),
        (described.couplings, "coupling"),
        (described.probes, "probe"),
    )
    counts = {name: len(those) for those, name in parts}
    if not as_json:
        print_line(str(described))
    read = [_read(file, described, as_json=as_json) for file in runs or ()]
    wrong = sum("wrong" in one for one in read)
    if as_json:
        print_json({"machine": described.id, **counts, "warnings": warnings, "runs": read})
    if wrong:
        fail(f"{wrong} of {len(read)} runs cannot be read")


def _read(file: Path, machine: "Machine", *, as_json: bool) -> dict[str, Any]:
    """Return what a run holds and what is wrong with its phasors, or why it cannot be read; printed unless as JSON."""
    from rotorundown.checks import checked_run
    from rotorundown.runs import WrongRun, read_run

    try:
        checked = checked_run(machine, read_run(file, machine=machine))
    except WrongRun as error:
        print_text(str(error), err=True)
        return {"file": file, "wrong": str(error)}
    if not as_json:
        print_text(str(checked))
    return {
        "file": file,
        "samples": len(checked.run),
        "units": checked.run.units,
        "left_out": checked.run.left_out,
        "findings": checked.findings,
        "unusable_phasors": checked.quality.counts,
    }
