"""Runs of a calibration, and the checks before its fit that they suffice for one."""

from collections.abc import Sequence
from itertools import combinations

import numpy as np
from msgspec import Struct

from estimator.arrays import Complexes
from estimator.calibration.likely_weights import UnlikelyWeight, require_likely_weights
from estimator.errors import Invalid
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement, joined

SAME_WEIGHT = 1e-6
"""Part of the largest trial weight up to which two are the same [-]."""


class CalibrationImpossible(Invalid):
    """Raised when runs cannot calibrate a machine, whatever their values."""


class CalibrationRun(Struct, frozen=True):
    """One recording of a calibration, S samples long.

    Attributes:
        name: Name, for messages and provenance.
        measurement: Its samples; `added` holds the known unbalances, None where they are not stated.
        mounting: Name of the mounting (S,) in which each sample was taken.
        steady: Whether each sample was taken at a constant speed.
        sha256: Checksum of the file, for provenance; empty where there is none.
        units: Unit in which the weights on each disc were given, empty where there were none; empty where nothing is known.
    """

    name: str
    measurement: Measurement
    mounting: tuple[str, ...]
    steady: bool
    sha256: str = ""
    units: tuple[str, ...] = ()


def check_runs(machine: Machine, runs: Sequence[CalibrationRun]) -> tuple[str, ...]:
    """Check that runs can calibrate a machine.

    Source: standard result: rank of the matrix of weights.

    Args:
        machine: The machine.
        runs: The runs.

    Returns:
        Remarks on what they leave open.

    Raises:
        CalibrationImpossible: A run does not state its weights or states impossible ones, or nothing differs between runs.
    """
    if not runs:
        raise CalibrationImpossible("a calibration needs runs: one as the machine is, and one with a known unbalance at least")
    for run in runs:
        if not np.any(run.measurement.speed > 0.0):
            raise CalibrationImpossible(
                f"{run.name}: its speed is zero throughout: did the keyphasor give pulses, and is its column the right one?"
            )
        _check_weights(machine, run)
    _require_no_copies(runs)
    added = joined([run.measurement for run in runs]).added
    if added is None or not np.any(np.abs(added) > 0.0):
        raise CalibrationImpossible(
            "no run has a trial weight: known unbalances are what gains are calibrated with; give them as `weights` "
            "of a request, `added_unbalance` of a sidecar"
        )
    largest = float(np.max(np.abs(added)))
    differs = np.max(np.abs(added - added[:1]), axis=0) > SAME_WEIGHT * largest
    if not differs.any():
        raise CalibrationImpossible(
            "all runs have the same trial weights: nothing tells them from the machine's own unbalance. A run without them, "
            "or with others, is needed"
        )
    remarks = [
        f"no trial weight was ever put on disc {disc.id}: what it does rests on the model alone"
        for disc, tried in zip(machine.discs, differs, strict=True)
        if not tried
    ]
    return (*remarks, *_alike(machine, added, differs))


def _check_weights(machine: Machine, run: CalibrationRun) -> None:
    added = run.measurement.added
    if added is None:
        raise CalibrationImpossible(
            f"{run.name} does not state which trial weights were on: `added_unbalance: none` for none, or by disc as in "
            "`added_unbalance: {" + machine.discs[0].id + ": {amount: 48, unit: g mm, angle_deg: 90}}`"
        )
    if added.shape[1] != len(machine.discs):
        raise CalibrationImpossible(
            f"{run.name} adds to {added.shape[1]} discs, machine '{machine.id}' has {len(machine.discs)}"
        )
    try:
        require_likely_weights(machine, added, name=run.name)
    except UnlikelyWeight as error:
        raise CalibrationImpossible(str(error)) from None


def _require_no_copies(runs: Sequence[CalibrationRun]) -> None:
    """Check that no run, and no mounting of one, holds the samples of another. Raises CalibrationImpossible.

    Single samples may well be alike: repeats of one condition in numbers that were rounded.
    """
    held: dict[tuple[int, str], set[bytes]] = {}
    for number, run in enumerate(runs):
        measurement = run.measurement
        for row, mounting in enumerate(run.mounting):
            if measurement.usable[row].any():
                phasors = np.where(measurement.usable[row], measurement.phasor[row], 0.0)
                held.setdefault((number, mounting), set()).add(np.r_[measurement.speed[row], phasors].tobytes())
    for ((first, before), ones), ((second, mounting), others) in combinations(held.items(), 2):
        if ones <= others or others <= ones:
            name = runs[second].name
            where = f"{before} and {mounting} of {name}" if first == second else f"{runs[first].name} and {name}"
            raise CalibrationImpossible(
                f"{where} hold the same samples: one is a copy of the other, not a run with another trial weight"
            )


def _alike(machine: Machine, added: Complexes, differs: np.ndarray) -> tuple[str, ...]:
    """State that discs always had weights in the same proportion, so that the model alone tells them apart."""
    tried = np.flatnonzero(differs)
    centred = added[:, tried] - added[:, tried].mean(axis=0)
    values = np.linalg.svd(centred / np.max(np.abs(centred), axis=0), compute_uv=False)
    if tried.size < 2 or values[min(values.size, tried.size) - 1] > 1e-3 * values[0]:
        return ()
    names = ", ".join(machine.discs[place].id for place in tried)
    return (f"discs {names} always had weights in the same proportion: only the model tells them apart",)
