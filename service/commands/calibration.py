"""Command that calibrates a machine from recorded runs with known unbalances, without a service."""

from pathlib import Path
from typing import Annotated

import typer
import yaml

from estimator.machine.document import Machine
from service.commands.exit import fail
from service.commands.terminal import say, say_lines

LINE_WIDTH = 120


def calibrate(
    machine: Annotated[Path, typer.Argument(help="machine document: what is known of the machine beforehand")],
    files: Annotated[list[Path], typer.Argument(help="recorded runs, each with its trial weights stated in its sidecar")],
    output: Annotated[
        Path | None, typer.Option(help="calibrated document to write; by default the document's name with -calibrated")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the random starts")] = 0,
) -> None:
    """Calibrate a machine from runs with known unbalances, and write the document that later fits start from.

    Gains, phases and run-outs of channels, moduli, coefficients and the machine's own unbalance are fitted to all runs
    together; what differs between mountings and how channels scatter comes from the runs. What they cannot determine is said
    and held at the document's values. Ends with status 1, and writes nothing, when the model does not fit.
    """
    import threadpoolctl

    from estimator.calibration.calibrate import calibrate as calibrated
    from service.commands.calibration_report import calibration_text
    from service.commands.document_warnings import say_warnings
    from service.configuration.document_files import UnreadableFile, read_machine
    from service.sources.recorded_runs import read_calibration_runs
    from service.wire import Rejected

    try:
        described = read_machine(machine)
        say_warnings(described)
        runs, left_out = read_calibration_runs(described, files)
        for line in left_out:
            say(line, err=True)
        with threadpoolctl.threadpool_limits(1):
            found = calibrated(described, runs, seed=seed)
    except (UnreadableFile, Rejected, ValueError) as error:
        fail(str(error))
    say_lines(calibration_text(found))
    if not found.accepted:
        raise typer.Exit(1)
    target = output or machine.with_name(f"{machine.stem}-calibrated.yaml")
    _write(target, found.machine)
    say(f"Written: {target}; `rundown identify {target} RUN` starts from it, and states the unbalance gained since")


def _write(path: Path, machine: Machine) -> None:
    content = machine.model_dump(mode="json", exclude_none=True)
    text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=LINE_WIDTH, allow_unicode=True)
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        fail(f"{path}: {error.strerror}")
