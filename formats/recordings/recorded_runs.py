"""Reads recorded runs as one measurement of a machine, without a service, and subtracts their slow roll on request."""

import hashlib
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from msgspec import Struct
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.arrays import Floats
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.likely_weights import UnlikelyWeight, require_likely_weights
from estimator.close_matches import did_you_mean
from estimator.machine.document import Machine
from estimator.machine.speed_units import outside_speed_range
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.quality import assess
from estimator.phasors.recorded_run import RecordedRun
from estimator.phasors.slow_roll import Capture, capture, corrected
from estimator.units import rpm_to_rad_per_s
from formats.files.document_files import UnreadableFile
from formats.recordings.exported_table import asks_for_thousands, lost_thousands
from formats.recordings.phase_units import contradicted_phase_unit, is_possible_of_one_channel
from formats.recordings.recording import RecordedCircumstances, read_circumstances, read_recording
from formats.recordings.run_times import doubted_times
from formats.recordings.standstill import at_standstill, standstill_words
from formats.wire import Rejected, SampleBatch, to_samples
from storage.clock import now

LOCAL_CLOCK = 14 * 3_600_000_000_000
"""Largest lead over UTC of a table's clock that states no zone [ns]."""
FEWEST_PHASES = 10
"""Rows from which on phases that are all zero are taken for ones that nobody measured."""


def read_measurement(machine: Machine, files: Sequence[Path], sidecar: Path | None = None) -> tuple[Measurement, list[str]]:
    """Return all runs of some files as one measurement, with descriptions of omitted rows; as `read_runs`."""
    runs, left_out = read_runs(machine, files, sidecar)
    return joined([measurement for _, measurement in runs]), left_out


def read_runs(
    machine: Machine, files: Sequence[Path], sidecar: Path | None = None
) -> tuple[list[tuple[RecordedRun, Measurement]], list[str]]:
    """Return the run of each file, as recorded and as a measurement, with descriptions of omitted rows.

    sidecar: replaces the one beside the file, for a single file. Raises UnreadableFile, and Rejected for a recording without
    this machine's channels.
    """
    if sidecar is not None and len(files) > 1:
        raise UnreadableFile("a sidecar can be given for one file only; with several, each has its own beside it")
    found = [_read(machine, file, sidecar) for file in files]
    return [(one.recorded, one.measurement) for one in found], [fault for one in found for fault in one.faults]


def read_calibration_runs(machine: Machine, files: Sequence[Path]) -> tuple[list[CalibrationRun], list[str]]:
    """Return each file as a run of a calibration, with descriptions of omitted rows; raises as `read_runs`."""
    found = [_read(machine, file, None) for file in files]
    runs = [_calibration_run(machine, file, one) for file, one in zip(files, found, strict=True)]
    return runs, [fault for one in found for fault in one.faults]


def read_mountings(
    machine: Machine, file: Path, sidecar: Path | None = None
) -> tuple[list[tuple[str, RecordedRun, Measurement]], list[str]]:
    """Return name, samples as recorded and as a measurement of each mounting in a file, with descriptions of omitted rows.

    Raises as `read_runs`.
    """
    read = _read(machine, file, sidecar)
    names = np.array(read.circumstances.mounting)[read.taken]
    parts = [(name, names == name) for name in dict.fromkeys(names.tolist())]
    return [(name, read.recorded.pick(which), read.measurement.pick(which)) for name, which in parts], read.faults


class _ReadRun(Struct, frozen=True, eq=False):
    """A file's run, as recorded and as a measurement, with what its sidecar states, the rows taken (R,) and the faults."""

    recorded: RecordedRun
    measurement: Measurement
    circumstances: RecordedCircumstances
    taken: NDArray[np.bool_]
    faults: list[str]


def _read(machine: Machine, file: Path, sidecar: Path | None) -> _ReadRun:
    recording = read_recording(file, sidecar)
    if recording.machine != machine.id:
        raise UnreadableFile(f"{file} is a recording of '{recording.machine}', the document describes '{machine.id}'")
    recording = _of_channels(recording, machine, file)
    if lost := lost_thousands(np.array(recording.speed)):
        raise UnreadableFile(f"{file}: {lost}")
    phase = np.array(recording.phase, dtype=float)
    _require_phases(phase, file)
    doubts = _phase_doubts(phase, recording.phase_unit, file)
    try:
        samples, taken, faults = to_samples(recording, machine, received_at=now() + LOCAL_CLOCK)
    except Rejected as error:
        raise Rejected(error.reason, f"{file}: {error}") from None
    outside = outside_speed_range(machine.speed_range, samples.speed[np.isfinite(samples.speed)])
    if outside and not taken.any():
        raise UnreadableFile(f"{file}: {outside}")
    asked = asks_for_thousands(np.array(recording.speed)) if outside else ""
    if asked and not outside_speed_range(machine.speed_range, 1e3 * samples.speed[np.isfinite(samples.speed)]):
        raise UnreadableFile(f"{file}: {outside}: {asked}")
    still = at_standstill(samples.speed, taken)
    if taken.any() and np.array_equal(still, taken):
        raise UnreadableFile(
            f"{file}: its speed is zero throughout: did the keyphasor give pulses, and is its column the right one?"
        )
    taken = taken & ~still
    run = samples.pick(taken)
    circumstances = read_circumstances(file, sidecar)
    recorded = run.recorded(machine.channels)
    if circumstances.kind == "dwells":
        recorded = replace(recorded, time=None)  # no sweep has gone through them
    else:
        if circumstances.unnamed:
            unnamed = f"column{'s' * (len(circumstances.unnamed) > 1)} {', '.join(map(repr, circumstances.unnamed))}"
            doubts.append(f"{file}, {unnamed} left out: no numbers, and not named by its sidecar")
        seconds = (samples.time - samples.time[0]) * 1e-9
        doubts += [f"{file}: {one}" for one in doubted_times(seconds, samples.speed, dated=circumstances.dated)]
    measurement = _with_trial_weights(machine, run.measurement(), circumstances, taken, file)
    words = [f"{file}, {fault.of_row(kept=bool(taken[fault.index]))}" for fault in faults if not still[fault.index]]
    words += [*(f"{file}, {one}" for one in standstill_words(still)), *([f"{file}: {outside}"] if outside else []), *doubts]
    return _ReadRun(recorded, measurement, circumstances, taken, words)


def _of_channels(recording: SampleBatch, machine: Machine, file: Path) -> SampleBatch:
    """Return a recording with channels as the document writes them. Raises Rejected for one that the machine has not."""
    folded = [one.casefold() for one in machine.channels]
    known = {plain: one for plain, one in zip(folded, machine.channels, strict=True) if folded.count(plain) == 1}
    channels = [one if one in machine.channels else known.get(one.casefold(), one) for one in recording.channels]
    unknown = next((one for one in channels if one not in machine.channels), None)
    if unknown is not None and (close := did_you_mean(unknown, machine.channels)):
        known_ids = ", ".join(machine.channels)
        raise Rejected(
            "unknown_channel", f"{file}: machine '{machine.id}' has no channel {unknown}; it has {known_ids}{close}"
        )
    twice = next((one for one in channels if channels.count(one) > 1), None)
    if twice is not None:
        raise UnreadableFile(f"{file}: its sidecar lists channel {twice} twice, in capitals and in small letters")
    return replace(recording, channels=channels)


def _require_phases(phase: Floats, file: Path) -> None:
    """Raise UnreadableFile where a recording's phases (S, m) are missing or zero throughout."""
    shown = phase[np.isfinite(phase)]
    if shown.size and (len(phase) < FEWEST_PHASES or np.any(shown != 0.0)):
        return
    why = "its phases are zero throughout" if shown.size else "it has no phases"
    raise UnreadableFile(f"{file}: {why}: did the keyphasor give pulses, and are the columns of phases the right ones?")


def _phase_doubts(phase: Floats, unit: str, file: Path) -> list[str]:
    """Return why phases (S, m) are probably in another unit. Raises UnreadableFile where they are in another one."""
    contradiction = contradicted_phase_unit(phase, unit)
    if contradiction is None:
        return []
    why, right = contradiction
    if is_possible_of_one_channel(phase, right):
        return [f"{file}: {why}, and is taken as the degrees that its sidecar says"]
    raise UnreadableFile(f"{file}: {why}: its sidecar should say phase_unit: {right}")


def _calibration_run(machine: Machine, file: Path, read: _ReadRun) -> CalibrationRun:
    measurement, steady = read.measurement, read.circumstances.kind == "dwells"
    if read.circumstances.stated and measurement.added is None:
        measurement = replace(measurement, added=np.zeros((measurement.speed.size, len(machine.discs)), dtype=complex))
    if not steady:
        usable = assess(read.recorded, noise=machine.noise, rules=machine.quality).usable
        measurement = replace(measurement, usable=measurement.usable & usable)
    mounting = tuple(name for name, taken in zip(read.circumstances.mounting, read.taken, strict=True) if taken)
    units = tuple(read.circumstances.units.get(disc.id, "") for disc in machine.discs)
    return CalibrationRun(file.name, measurement, mounting, steady, hashlib.sha256(file.read_bytes()).hexdigest(), units)


def speed_band(text: str) -> tuple[float, float]:
    """Parse a band such as 200:400 [r/min] into its lowest and highest speed [rad/s]. Raises ValueError."""
    parts = text.split(":")
    try:
        lowest, highest = (rpm_to_rad_per_s(float(part)) for part in parts)
    except ValueError:
        raise ValueError(f"'{text}' is no speed band; one is written as 200:400, in r/min") from None
    if not 0.0 < lowest < highest < math.inf:
        raise ValueError(f"'{text}' is no speed band: it needs two positive speeds, the lower one first")
    return lowest, highest


def captured_slow_roll(machine: Machine, measurement: Measurement, band: str) -> Capture:
    """Capture slow-roll vectors from a band of a recording. Raises NotSlowRoll, ValueError."""
    lowest, highest = speed_band(band)
    return capture(machine, measurement, lowest=lowest, highest=highest)


def without_slow_roll(
    machine: Machine, runs: Sequence[tuple[RecordedRun, Measurement]], band: str
) -> tuple[Machine, list[tuple[RecordedRun, Measurement]], Capture]:
    """Return a machine and its runs without the slow-roll vectors of a band; raises as `captured`.

    The band's own samples are omitted from the result: their information is used up.
    """
    found = captured_slow_roll(machine, joined([measurement for _, measurement in runs]), band)
    lowest, highest = speed_band(band)
    described, rest = machine, []
    for run, measurement in runs:
        outside = (measurement.speed < lowest) | (measurement.speed > highest)
        described, without = corrected(machine, measurement.pick(outside), found.slow_roll)
        rest.append((run.pick(outside), without))
    return described, rest, found


def _with_trial_weights(
    machine: Machine, run: Measurement, circumstances: RecordedCircumstances, taken: NDArray[np.bool_], file: Path
) -> Measurement:
    discs = [disc.id for disc in machine.discs]
    unknown = sorted(set(circumstances.added) - set(discs))
    if unknown:
        raise UnreadableFile(f"the sidecar of {file} adds unbalance to {', '.join(unknown)}; the discs are {', '.join(discs)}")
    if not circumstances.added:
        return run
    added = np.zeros((run.speed.size, len(discs)), dtype=complex)
    for disc, unbalances in circumstances.added.items():
        added[:, discs.index(disc)] = np.array(unbalances)[taken]
    try:
        require_likely_weights(machine, added, name=str(file))
    except UnlikelyWeight as error:
        raise UnreadableFile(str(error)) from None
    if circumstances.kind == "sweep" and np.any(np.abs(added - added[:1]) > 0.0):
        raise UnreadableFile(
            f"{file}: trial weights differ from row to row of one sweep; where each row was taken at a constant speed, "
            "its sidecar says `kind: dwells`"
        )
    return replace(run, added=added)
