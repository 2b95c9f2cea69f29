"""Runs of a calibrated machine whose bearings or couplings have changed since its calibration.

A coupling that goes out of alignment contradicts the calibration, as it should: the run is then fitted again with all
coefficients free, and with the measuring chains and materials still held, which such a fault leaves as they are. Chains that
changed contradict it, too, and free coefficients would take that for theirs: both views are compared by the Bayesian
information criterion (Schwarz, Ann. Statist. 6 (1978) 461, doi:10.1214/aos/1176344136), and neither is believed where it is
not clear. What is not freed keeps the marginal of the calibration's joint Gaussian (Rasmussen and Williams, Gaussian Processes
for Machine Learning, 2006, app. A.2).
"""

import math

import numpy as np
from msgspec.structs import replace

from estimator.fit.problem.fit_problem import FitProblem, FitResult
from estimator.fit.validation.calibration_conflict import CalibrationConflict, calibration_conflict
from estimator.machine.calibration import LASTING
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.rotor.condensation import CondensedTrain

CLEAR = 10.0
"""Difference of the criterion that is very strong evidence [-] (Kass and Raftery, J. Am. Stat. Assoc. 90 (1995) 773)."""


def without_calibrated_coefficients(machine: Machine) -> Machine:
    """Return a machine whose calibration holds no coefficients of bearings, couplings and pedestals.

    Args:
        machine: The machine, calibrated or not.

    Returns:
        The machine, with what its calibration says of channels, materials and unbalances.
    """
    held = () if machine.calibration is None else machine.calibration.parameters
    return _held_by(machine, {name for name in held if describe(name).element_kind in LASTING})


def without_coefficients_of_calibration(train: CondensedTrain) -> CondensedTrain:
    """Return a train whose calibration holds no coefficients.

    Args:
        train: The condensed train of a calibrated machine.

    Returns:
        The train.
    """
    return train if train.machine is None else replace(train, machine=without_calibrated_coefficients(train.machine))


def without_gains_of_calibration(train: CondensedTrain) -> CondensedTrain:
    """Return a train whose calibration holds no gains of channels.

    Args:
        train: The condensed train of a calibrated machine.

    Returns:
        The train.
    """
    machine = train.machine
    if machine is None or machine.calibration is None:
        return train
    held = {name for name in machine.calibration.parameters if describe(name).quantity != "gain"}
    return replace(train, machine=_held_by(machine, held))


def freed_criterion(problem: FitProblem, found: FitResult, *, held: int) -> float:
    """Compute the Bayesian information criterion of a fit that frees a part of what a calibration holds.

    Source: Schwarz, Ann. Statist. 6 (1978) 461, doi:10.1214/aos/1176344136.

    Args:
        problem: The fit's problem.
        found: The fit.
        held: Number of parameters that the whole calibration holds.

    Returns:
        The criterion, smaller is better [-].
    """
    left = calibration_conflict(problem, found)
    chi_square = found.chi_square if left is None else left.chi_square
    freed = held - len(problem.coordinates.calibrated_places)
    return chi_square + freed * math.log(2 * np.count_nonzero(problem.measurement.usable))


def changed_words(conflict: CalibrationConflict) -> str:
    """Describe an accepted fit whose coefficients are freed of the calibration.

    Args:
        conflict: How the run contradicts the calibration.

    Returns:
        The remark in words.
    """
    return (
        "bearings or couplings have changed since the calibration: their coefficients are fitted without it, measuring "
        f"chains and materials with it (with all of it χ²/dof {conflict.chi_square / conflict.freedom:.3g})"
    )


def _held_by(machine: Machine, names: set[str]) -> Machine:
    """Return a machine of whose calibration only some parameters are held."""
    if machine.calibration is None:
        return machine
    return machine.model_copy(update={"calibration": machine.calibration.of_parameters(names)})
