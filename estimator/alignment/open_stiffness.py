"""Couplings whose stiffness single runs leave open, so that no offset in micrometres follows from the load that it makes.

A run sees the load that an offset makes. Where a soft coupling takes the offset up, it is that load over the coupling's
stiffness: if this is known to a factor only, so is the offset, and an interval to first order would be far too narrow. A rigid
coupling may be of any stiffness above that of the shafts, which then make the load.
"""

import math
from collections.abc import Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.statics.alignment import alignment_motions
from estimator.statics.coupled_train import CoupledTrain, coupled_train
from estimator.updated_model.model import UpdatedModel

OPEN = 0.5
"""Standard error of the logarithm of a coupling's stiffness from which on runs leave it open [-]."""
PLANES = (("horizontal", 0), ("vertical", 1))
"""Planes in the order of x and y."""


def open_alignments(runs: Sequence[UpdatedModel]) -> dict[str, str]:
    """Return the offsets and angles whose load follows by a stiffness that single runs leave open, each with the reason.

    Derived here: errors of the logarithms of stiffnesses add to that of the load per unit of offset, each by the part by which
    the load follows it (first order: JCGM 100:2008, 5.2).

    Args:
        runs: Models of some runs of one machine on oil films, at least one.

    Returns:
        Reasons by name, such as `coupling.C1.offset_vertical`.
    """
    newest = runs[-1]
    train = coupled_train(newest.machine)
    errors = _stiffness_errors(runs, train)
    if not np.any(errors >= OPEN):
        return {}
    ways = _ways(newest.machine)
    statics = train.at(_factors(newest, train))
    found = {}
    for name, way in ways.items():
        made = float(way @ statics.stiffness @ way)
        follows = np.einsum("i,cij,j->c", way, statics.slopes.stiffness, way) / made
        open_by = float(np.linalg.norm(follows * errors))
        if open_by >= OPEN:
            found[name] = (
                f"single runs leave the coupling's stiffness open, by which its load follows: ± {100 * open_by:.0f} %"
            )
    return found


def _stiffness_errors(runs: Sequence[UpdatedModel], train: CoupledTrain) -> Floats:
    """Return the usual standard error (C,) of the logarithm of each stiffness in a single run; 0 of a pedestal's [-]."""
    couplings = [describe(one.name).element_kind == "coupling" for one in train.parameters]
    places = [_place(runs[-1], one.name) if of else None for one, of in zip(train.parameters, couplings, strict=True)]
    each = [[0.0 if at is None else float(np.sqrt(run.covariance[at, at])) for at in places] for run in runs]
    return np.asarray(np.median(np.array(each).reshape(len(runs), len(places)), axis=0), dtype=float)


def _factors(model: UpdatedModel, train: CoupledTrain) -> Floats:
    """Return the stiffnesses that a run has found over the document's (C,) [-]."""
    expected = model.coordinates_at(np.ones(1)).origin  # logarithms of the document's values
    places = [_place(model, one.name) for one in train.parameters]
    return np.array([1.0 if at is None else math.exp(model.values[at] - expected[at]) for at in places])


def _place(model: UpdatedModel, name: str) -> int | None:
    return model.coordinates.index(name) if name in model.coordinates else None


def _ways(machine: Machine) -> dict[str, Floats]:
    """Return the motion (2n,) of all bearings that makes a unit of each offset and angle in either plane."""
    found = {}
    for plane, axis in PLANES:
        for name, motion in alignment_motions(machine).items():
            way = np.zeros((len(motion), 2))
            way[:, axis] = motion
            found[f"{name}_{plane}"] = way.reshape(-1)
    return found
