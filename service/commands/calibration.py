"""Command that calibrates a machine from recorded runs with known unbalances, without a service."""

from pathlib import Path
from typing import Annotated

import typer

from service.commands.exit import fail
from service.commands.file_arguments import named_file, named_files, written_beside
from service.commands.json_output import JsonOption, print_json
from service.commands.terminal import print_line, print_text, working


def calibrate(
    machine: Annotated[
        Path, typer.Argument(help="machine document: what is known of the machine beforehand", callback=named_file)
    ],
    files: Annotated[
        list[Path],
        typer.Argument(help="recorded runs, each with its trial weights stated in its sidecar", callback=named_files),
    ],
    output: Annotated[
        Path | None, typer.Option(help="calibrated document to write; by default the document's name with -calibrated")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random starts")] = 0,
    gain_drift: Annotated[
        float, typer.Option(min=0.0, max=50.0, help="rms by which channels' gains may have changed until a later run [%]")
    ] = 0.0,
    as_json: JsonOption = False,
) -> None:
    """Calibrate a machine from runs with known unbalances, and write the document that later fits start from.

    Gains, phases and run-outs of channels, moduli, coefficients and the machine's own unbalance are fitted to all runs
    together; what differs between mountings and how channels scatter comes from the runs. What they cannot determine is said
    and held at the document's values. Ends with status 1, and writes nothing, when the model does not fit.
    """
    from formats.files.document_files import UnreadableFile, read_machine
    from rotorundown.calibration import NotCalibrated, require_replaceable
    from rotorundown.calibration import calibrate as calibrated
    from service.commands.document_warnings import print_warnings

    target = output or written_beside(machine, f"{machine.stem}-calibrated.yaml")
    try:
        require_replaceable(target)
        described = read_machine(machine)
        print_warnings(described)
        with working("calibrating"):
            found = calibrated(described, files, seed=seed, gain_drift=gain_drift / 100.0, report=_print_at_once)
    except (UnreadableFile, NotCalibrated) as error:
        fail(str(error))
    if as_json:
        said = found.found
        told = {"machine": described.id, "accepted": found.accepted, "verdict": found.verdict, "remarks": said.remarks}
        print_json(told | {"starts": said.starts, "calibration": found.machine.calibration})
    else:
        print_text(str(found))
    if not found.accepted:
        raise typer.Exit(1)
    try:
        found.write(target)
    except NotCalibrated as error:
        fail(str(error))
    print_line(
        f"Written: {target}; `rundown identify {target} RUN` starts from it, and states the unbalance gained since",
        err=as_json,
    )
    for doubt in found.found.doubts:
        print_line(f"Before you use it: {doubt}", err=True)


def _print_at_once(line: str) -> None:
    """Print what was left out of a recording, or speaks against it, as soon as it is known."""
    print_line(line, err=True)
