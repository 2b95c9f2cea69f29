"""Calibrates a machine from recorded runs with known unbalances, as `rundown calibrate` does."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from numbers import Integral, Real
from os import PathLike
from pathlib import Path
from typing import Any

import yaml

from estimator.calibration.calibrate import Calibrated, with_named_senses
from estimator.calibration.calibrate import calibrate as calibrate_runs
from estimator.calibration.calibrated_document import require_gain_drift, with_gain_drift
from estimator.errors import Invalid
from estimator.machine.document import Machine
from formats.files.document_files import UnreadableFile
from formats.recordings.recorded_runs import read_calibration_runs
from formats.wire import Rejected
from rotorundown.environment.blas_threads import one_blas_thread
from rotorundown.environment.example_machines import found_example
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package
from rotorundown.summaries.calibrated_values import CALIBRATED_COLUMNS, calibrated_rows
from rotorundown.summaries.calibration_summary import calibration_text

LINE_WIDTH = 120


class NotCalibrated(Invalid):
    """Raised when runs cannot calibrate a machine; the message says why."""


@dataclass(frozen=True, eq=False)
class CalibratedMachine:
    """Outcome of a calibration.

    Attributes:
        found: The calibrated machine, the verdict on it, and what the runs could not determine.
        left_out: Rows that were left out when the recordings were read, with the reason of each.
    """

    found: Calibrated
    left_out: tuple[str, ...] = ()

    @property
    def machine(self) -> Machine:
        """Return the machine with the calibration in its document: later fits start from it."""
        return self.found.machine

    @property
    def accepted(self) -> bool:
        """Return whether the calibration may be used."""
        return self.found.accepted

    @property
    def verdict(self) -> str:
        """Return the verdict in words."""
        return self.found.verdict

    def write(self, file: str | Path) -> None:
        """Write the calibrated document as YAML, or over one that was written before.

        Raises NotCalibrated for one that is not accepted, or where another file is in the way or it cannot be written.
        """
        if not self.accepted:
            raise NotCalibrated(f"nothing is written, for the calibration is not accepted: {self.verdict}")
        if not isinstance(file, str | PathLike):
            raise NotCalibrated(f"file is a {type(file).__name__}: give the path of the document to write")
        require_replaceable(Path(file))
        content = self.machine.model_dump(mode="json", exclude_none=True)
        text = yaml.safe_dump(content, sort_keys=False, default_flow_style=None, width=LINE_WIDTH, allow_unicode=True)
        try:
            Path(file).write_text(text, encoding="utf-8")
        except OSError as error:
            folder = Path(file).parent
            why = error.strerror if folder.is_dir() else f"there is no folder {folder}, make it first"
            raise NotCalibrated(f"{file} cannot be written: {why}") from None

    def to_frame(self) -> Any:
        """Return a pandas DataFrame with a row per calibrated parameter, in SI units. Raises PackageMissing without pandas.

        Gains are measured over true; complex parameters have an imaginary part. A refused calibration may have no row.
        """
        pandas = optional_package("pandas", needed_for="data frames")
        calibration = self.machine.calibration
        rows = [] if calibration is None else list(calibrated_rows(calibration))
        return pandas.DataFrame(rows, columns=["parameter", *CALIBRATED_COLUMNS]).set_index("parameter")

    def __str__(self) -> str:
        return calibration_text(self.found)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook, escaped."""
        return notebook_text(self)


def require_replaceable(file: Path) -> None:
    """Check that a file may be written: none is there, or a calibrated document. Raises NotCalibrated for another file."""
    if file.is_file() and not re.search(r"^calibration:", file.read_text(encoding="utf-8", errors="replace"), re.MULTILINE):
        raise NotCalibrated(f"{file} is there already, and is no calibrated document: name another file to write")


def calibrate(
    machine: Machine,
    files: Iterable[str | PathLike[str]],
    *,
    seed: int = 0,
    gain_drift: float = 0.0,
    report: Callable[[str], None] | None = None,
) -> CalibratedMachine:
    """Calibrate a machine from recorded runs with known unbalances.

    Gains, phases and run-outs of channels, moduli, coefficients and the machine's own unbalance are fitted to all runs.

    Args:
        machine: The machine, with what is known of it beforehand.
        files: Paths of recordings, whose sidecars state which trial weights were on (`added_unbalance`).
        seed: Seed of the random starts.
        gain_drift: By how much channels' gains may have changed by the time of a later run, rms, in parts of them [-].
        report: Called with each row that is left out, and each doubt of the recordings, before the fit begins.

    Returns:
        The calibration. One that is not accepted is returned too, and says so: look at `accepted` before using it.

    Raises:
        NotCalibrated: A file cannot be read, states no or impossible weights, or nothing differs between the runs.
    """
    if not isinstance(machine, Machine):
        raise NotCalibrated(f"the machine is a {type(machine).__name__}: read it first, with read_machine(…)")
    if not isinstance(seed, Integral) or seed < 0:
        raise NotCalibrated(f"seed is a whole number from 0 up, not {seed!r:.40}")
    if isinstance(gain_drift, bool) or not isinstance(gain_drift, Real):
        raise NotCalibrated(f"gain_drift is a number from 0 up, such as 0.02 for 2 %, not {gain_drift!r:.40}")
    if isinstance(files, str | PathLike):
        raise NotCalibrated(f"files is one path, {files}: give a list of the recordings with and without weights")
    if not isinstance(files, Iterable):
        raise NotCalibrated(f"files is a {type(files).__name__}: give a list of the recordings with and without weights")
    files = list(files)
    wrong = [type(one).__name__ for one in files if not isinstance(one, str | PathLike)]
    if wrong:
        raise NotCalibrated(f"a recording is a {wrong[0]}: give paths of files, whose sidecars state the weights")
    try:
        require_gain_drift(gain_drift)
        runs, left_out = read_calibration_runs(machine, [found_example(Path(file)) for file in files])
        if report is not None:
            for line in left_out:
                report(line)
        with one_blas_thread():
            found = calibrate_runs(machine, runs, seed=seed)
            found = with_named_senses(machine, runs, found, seed=seed)
        drifting = replace(found, machine=with_gain_drift(found.machine, gain_drift))
        return CalibratedMachine(drifting, tuple(left_out))
    except (UnreadableFile, Rejected, ValueError) as error:
        raise NotCalibrated(str(error)) from None
