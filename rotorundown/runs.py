"""Runs as the library takes them: recordings with a sidecar, plain CSV tables, data frames, or arrays."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import Struct
from msgspec.structs import replace

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.recorded_run import RecordedRun
from estimator.units import (
    METRES,
    PEAK,
    RAD_PER_S,
    AmplitudeKind,
    AmplitudeUnit,
    PhaseConvention,
    PhaseUnit,
    SpeedUnit,
)
from formats.files.document_files import UnreadableFile
from formats.recordings.sidecar_place import is_plain_table, sidecar_of
from formats.wire import Rejected, as_sent
from rotorundown.environment.example_machines import found_example
from rotorundown.environment.notebook_text import notebook_text
from rotorundown.environment.optional_packages import optional_package
from rotorundown.run_columns import GAP_END, WrongRun
from rotorundown.run_tables import FIRST_LINE, RunTable, read_csv_table
from rotorundown.run_units import UNIT_OPTIONS, TableUnits

__all__ = ["MachineRun", "WrongRun", "read_run"]


MOST_LEFT_OUT = 5
"""Most left-out samples that are printed."""


class MachineRun(Struct, frozen=True, eq=False):
    """A recorded run of a machine, S samples of its m channels.

    Attributes:
        name: Name of the run: that of its file, or `run`.
        channels: Ids of the m channels.
        recorded: The samples as they were measured, by which their quality is judged.
        measurement: The same samples as input of a fit, with the trial weights that were on.
        left_out: What was left out when it was read, with the reason of each, and channels whose phases are doubted.
        units: Units in which it was read.
        truth: True parameters of a simulated run by name [SI]; None for a measured one.
        gap_um: Mean gaps (S, m) as `gap_grows` of the document says that they grow [µm], NaN where there are none; None
            without any.
    """

    name: str
    channels: tuple[str, ...]
    recorded: RecordedRun
    measurement: Measurement
    left_out: tuple[str, ...] = ()
    units: str = "as its sidecar says"
    truth: Mapping[str, float] | None = None
    gap_um: Floats | None = None

    def __len__(self) -> int:
        return int(self.recorded.speed.size)

    @property
    def speed_rpm(self) -> Floats:
        """Return the speeds (S,) [r/min]."""
        return np.asarray(self.recorded.speed / RAD_PER_S["rpm"])

    @property
    def amplitude_um_pp(self) -> Floats:
        """Return the amplitudes (S, m) [µm peak-to-peak]."""
        return np.asarray(np.abs(self.recorded.phasor) / (METRES["um"] * PEAK["peak-to-peak"]))

    @property
    def phase_lag_deg(self) -> Floats:
        """Return the phase lags (S, m) [°], from 0 to 360."""
        return np.asarray(-np.degrees(np.angle(self.recorded.phasor)) % 360.0)

    @property
    def interval_s(self) -> float:
        """Return the time between the first two samples [s]. Raises WrongRun where no times are known."""
        if self.recorded.time is None or len(self) < 2:
            raise WrongRun(f"the run '{self.name}' has no times")
        return float(self.recorded.time[1] - self.recorded.time[0])

    def to_frame(self) -> Any:
        """Return a pandas DataFrame that `read_run` reads again, with times [s] and gaps [µm] where there are any.

        Its columns are the time since the first sample, the speed [r/min], amplitude [µm pp] and phase lag [°] of each
        channel, then the gaps.
        Raises PackageMissing without pandas.
        """
        time = self.recorded.time
        columns: dict[str, Floats] = {} if time is None else {"time_s": time - time[:1]}
        columns["speed_rpm"] = self.speed_rpm
        for number, channel in enumerate(self.channels):
            columns[f"{channel}_um_pp"] = self.amplitude_um_pp[:, number]
            columns[f"{channel}_lag_deg"] = self.phase_lag_deg[:, number]
        for number, channel in enumerate(self.channels):
            if self.gap_um is not None and np.isfinite(self.gap_um[:, number]).any():
                columns[f"{channel}{GAP_END}"] = self.gap_um[:, number]
        return optional_package("pandas", needed_for="data frames").DataFrame(columns)

    def __str__(self) -> str:
        lines = [
            f"{self.name}: {len(self)} sample{'' if len(self) == 1 else 's'}, {', '.join(self.channels)}; read {self.units}"
        ]
        if len(self):
            lines.append(
                f"{self.speed_rpm.min():.0f} to {self.speed_rpm.max():.0f} r/min; "
                f"largest amplitude {np.nanmax(self.amplitude_um_pp):.3g} µm pp"
            )
        lines += self.left_out[:MOST_LEFT_OUT]
        if len(self.left_out) > MOST_LEFT_OUT:
            lines.append(f"and {len(self.left_out) - MOST_LEFT_OUT} more left out")
        return "\n".join(lines)

    __repr__ = __str__

    def _repr_html_(self) -> str:
        """Return the text for a notebook; names come from files, so everything is escaped."""
        return notebook_text(self)


def other_channels(run: MachineRun, machine: Machine) -> str:
    """Return what is wrong where a run has other channels than a machine, nothing where it has the same."""
    if run.channels == machine.channels:
        return ""
    known = f"machine '{machine.id}' has {', '.join(machine.channels)}"
    return f"run '{run.name}' has the channels {', '.join(run.channels)}, {known}: read it with this machine"


def read_run(
    source: Any,
    *,
    machine: Machine,
    sidecar: str | Path | None = None,
    speed_unit: SpeedUnit = "rpm",
    amplitude_unit: AmplitudeUnit = "um",
    amplitude_kind: AmplitudeKind = "peak-to-peak",
    phase_convention: PhaseConvention = "lag",
    phase_unit: PhaseUnit | None = None,
) -> MachineRun:
    """Return a run of a machine.

    Without a sidecar the units are those given here, and a table needs a column `speed` (or `speed_rpm`, `rpm`), where known
    `time` (or `time_s`) [s] or as dates, and for each channel such as `B1L` the columns `B1L_amplitude` and `B1L_phase` (or
    `B1L_um_pp` and `B1L_lag_deg`, as `rundown sample` writes them). A column `B1L_gap_um` holds the probe's mean gap [µm],
    which grows as `gap_grows` of the document says. Without times the rate of the sweep is not judged. Units may have the
    names that people and instruments give them, such as `µm`, `r/min`, `pp` or `°`.

    Args:
        source: Path of a CSV file or a measuring system's, whose sidecar is used where one stands beside it; or a data frame,
            a mapping of columns, or a structured array.
        machine: The machine.
        sidecar: Path of another sidecar, for a file.
        speed_unit: Unit of the speeds; where there is a sidecar, it says all units.
        amplitude_unit: Unit of the amplitudes.
        amplitude_kind: Whether amplitudes are 0-to-peak (`peak`) or peak-to-peak.
        phase_convention: Whether phases lag or lead.
        phase_unit: Unit of the phases; None for degrees, unless those of a single channel look like radians.

    Returns:
        The run.

    Raises:
        WrongRun: The file cannot be read, or its columns or numbers cannot be a run of this machine.
    """
    if not isinstance(machine, Machine):
        raise WrongRun(f"machine is a {type(machine).__name__}: read it first, with read_machine(…)")
    units = TableUnits.named(
        speed_unit=speed_unit,
        amplitude_unit=amplitude_unit,
        amplitude_kind=amplitude_kind,
        phase_convention=phase_convention,
        phase_unit=phase_unit,
    )
    if not isinstance(source, str | Path):
        return _run_of_table(RunTable.of(source), "run", machine, units)
    path = found_example(Path(source))
    if path.is_dir():
        raise WrongRun(f"{path} is a folder: name a file of it")
    if sidecar is None and is_plain_table(path):
        return _run_of_plain_file(path, machine, units)
    return _run_of_recording(path, machine, sidecar_of(path) if sidecar is None else Path(sidecar), units)


def _run_of_recording(path: Path, machine: Machine, sidecar: Path, units: TableUnits) -> MachineRun:
    """Return the run in a recording with its sidecar. Raises WrongRun, also where units are given that it contradicts."""
    # Vendors' formats, trial weights, slow roll: loaded with the first recording, not with the first table.
    from formats.recordings.recorded_runs import read_runs
    from formats.recordings.sidecar import read_sidecar

    try:
        runs, left_out = read_runs(machine, [path], sidecar)
        said = read_sidecar(sidecar)
    except (UnreadableFile, Rejected) as error:
        raise WrongRun(str(error)) from None
    for option, unit in units.given.items():
        if unit != getattr(said, option):
            raise WrongRun(f"{path}: {option} says {unit}, but its sidecar {getattr(said, option)}: leave {option} out")
    recorded, measurement = runs[0]
    gap = sent_gaps(measurement, machine)
    return MachineRun(path.name, machine.channels, recorded, measurement, tuple(left_out), gap_um=gap)


def sent_gaps(measurement: Measurement, machine: Machine) -> Floats | None:
    """Return the gaps (S, m) of a measurement as the document says that they grow [µm]; None where it has none."""
    return None if measurement.gaps is None else as_sent(measurement.gaps.place, machine)


def _run_of_plain_file(path: Path, machine: Machine, units: TableUnits) -> MachineRun:
    """Return the run in a table without a sidecar. Raises WrongRun, which names the file and where its units are told."""
    first = FIRST_LINE
    try:
        table = read_csv_table(path)
        first = table.first_line
        return _run_of_table(table, path.name, machine, units)
    except WrongRun as error:
        where = "" if str(path) in str(error) else f"{path}: "
        counted = f" (row 1 is line {first})" if first != FIRST_LINE and " row " in str(error) else ""
        told = any(option in str(error) for option in UNIT_OPTIONS)
        sidecar = f" (or in a sidecar, {path.with_suffix('.yaml').name})" if told else ""
        raise WrongRun(f"{where}{error}{counted}{sidecar}") from None


def _run_of_table(table: RunTable, name: str, machine: Machine, units: TableUnits) -> MachineRun:
    table = table.named(machine, units)
    try:
        samples, left_out = table.samples(machine, units, name)
    except Rejected as error:
        raise WrongRun(f"{name}: {error}") from None
    recorded = samples.recorded(machine.channels)
    if table.time is None:
        recorded = replace(recorded, time=None)
    measurement = samples.measurement()
    gap = sent_gaps(measurement, machine)
    return MachineRun(name, machine.channels, recorded, measurement, left_out, f"as {units.words}", gap_um=gap)
