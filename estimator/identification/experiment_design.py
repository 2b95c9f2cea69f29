"""Choice of further speeds or probes: the gain in Fisher information that each would bring to an identification.

A further measurement with weighted sensitivities J (rows: its real numbers) turns the covariance C of the unknowns into (C⁻¹ +
JᵀJ)⁻¹, whatever will be measured. Candidates are taken one by one, each the best beside those taken before: the one that makes
the geometric mean of the wanted standard errors smallest (optimal design in the sense of Atkinson, Donev and Tobias, Optimum
Experimental Designs, Oxford 2007, with a criterion that does not depend on units). Every channel counts as measured with the
noise model's error; trial weights of the run take no part.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import Floats
from estimator.fit.identification import Identification
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.phasor_jacobian import phasor_jacobian
from estimator.machine.document import Machine
from estimator.machine.mesh import node_stations
from estimator.machine.parts import Probe
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import sensitivity
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s


@dataclass(frozen=True)
class Benefit:
    """Effect of one further measurement, beside those before it in the list.

    Attributes:
        what: Description of the measurement.
        shrinkage: Factor on the geometric mean of the targets' standard errors [-]; below 1 is better.
        standard_error: Standard errors (N,) of all coordinates afterwards [SI, logarithms of direct terms].
    """

    what: str
    shrinkage: float
    standard_error: Floats


@dataclass(frozen=True)
class HelpfulSpeed(Benefit):
    """Effect of one more sample at a speed.

    Attributes:
        speed: Speed [rad/s].
    """

    speed: float


@dataclass(frozen=True)
class HelpfulProbe(Benefit):
    """Effect of a further probe that measures at all speeds of the run.

    Attributes:
        probe: The probe and its place.
    """

    probe: Probe


def helpful_speeds(
    machine: Machine,
    identification: Identification,
    *,
    candidates: Floats,
    count: int = 3,
    targets: Sequence[str] | None = None,
) -> tuple[HelpfulSpeed, ...]:
    """Choose the speeds at which one more sample each helps most (Atkinson, Donev and Tobias 2007).

    Speeds outside the document's range are none that a machine may be asked to run at.

    Source: Atkinson, Donev and Tobias, Optimum Experimental Designs, Oxford 2007.

    Args:
        machine: The machine.
        identification: Its identification.
        candidates: Candidate speeds (C,) [rad/s]; those outside the speed range are left out.
        count: Number of speeds to choose.
        targets: Names of coordinates to be known better; None for all.

    Returns:
        Chosen speeds [rad/s] with their effect, in the order in which they were chosen.

    Raises:
        ValueError: A target is no coordinate of the identification, the identification is of other unknowns, or no candidate
            lies in the speed range.
    """
    candidates = _within_range(machine, np.asarray(candidates, dtype=float))
    rows = _rows(machine, identification, candidates)
    chosen = _greedy(list(rows), identification, count, targets)
    return tuple(
        HelpfulSpeed(f"one more sample at {rad_per_s_to_rpm(candidates[i]):.0f} r/min", shrinkage, error, float(candidates[i]))
        for i, shrinkage, error in chosen
    )


def helpful_probes(
    machine: Machine,
    identification: Identification,
    measurement: Measurement,
    *,
    count: int = 3,
    targets: Sequence[str] | None = None,
) -> tuple[HelpfulProbe, ...]:
    """Choose the probes, x or y at a node of the model, that would help most had they measured the same run.

    Source: Atkinson, Donev and Tobias, Optimum Experimental Designs, Oxford 2007.

    Args:
        machine: The machine.
        identification: Its identification.
        measurement: The run.
        count: Number of probes to choose.
        targets: Names of coordinates to be known better; None for all.

    Returns:
        Chosen probes with their effect, in the order in which they were chosen.

    Raises:
        ValueError: A target is no coordinate of the identification, or the identification is of other unknowns.
    """
    probes = _candidate_probes(machine)
    extended = machine.model_copy(update={"probes": (*machine.probes, *probes)})
    rows = _rows(extended, identification, measurement.speed, direction=measurement.direction, nuisance=machine)
    per_probe = [rows[:, len(machine.probes) + k] for k in range(len(probes))]
    chosen = _greedy([one.reshape(-1, rows.shape[-1]) for one in per_probe], identification, count, targets)
    return tuple(
        HelpfulProbe(
            f"a probe on shaft {probes[i].shaft} at {probes[i].station:.4g} m, {probes[i].angle_deg:g}°",
            shrinkage,
            error,
            probes[i],
        )
        for i, shrinkage, error in chosen
    )


def _within_range(machine: Machine, candidates: Floats) -> Floats:
    limits = machine.speed_range
    lowest, highest = rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm)
    # The ends of the range themselves count, rounded or not.
    within = candidates[(candidates >= lowest * (1 - 1e-9)) & (candidates <= highest * (1 + 1e-9))]
    if within.size == 0:
        raise ValueError(f"no candidate lies in the speed range, {limits.minimum_rpm:g} to {limits.maximum_rpm:g} r/min")
    return within


def _candidate_probes(machine: Machine) -> list[Probe]:
    """List x and y at every node that has no probe yet."""
    taken = {(p.shaft, round(p.station, 6)) for p in machine.probes}
    return [
        Probe(id=f"candidate-{shaft.id}-{k}-{angle}", shaft=shaft.id, station=float(station), angle_deg=angle)
        for shaft in machine.shafts
        for k, station in enumerate(node_stations(machine, shaft))
        if (shaft.id, round(float(station), 6)) not in taken
        for angle in (0, 90)
    ]


def _rows(
    machine: Machine,
    identification: Identification,
    speed: Floats,
    *,
    direction: Floats | None = None,
    nuisance: Machine | None = None,
) -> Floats:
    """Compute weighted sensitivities (S, m, 2, N) of further phasors over the identification's coordinates.

    nuisance: the machine whose probes had gains and run-outs identified; further probes are taken as exact.
    """
    sense = np.full(speed.size, float(machine.direction)) if direction is None else direction
    train = condense(machine, speed=speed, direction=sense)
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    if coordinates.names != identification.coordinates:
        owner = (nuisance or machine).id
        raise ValueError(f"the identification is of other unknowns than those of machine '{owner}'")
    theta = coordinates.theta(identification.point)
    return np.concatenate([_block(train, coordinates, theta, identification, block) for block in train.blocks()])


def _block(
    train: CondensedTrain, coordinates: Coordinates, theta: Floats, identification: Identification, block: slice
) -> Floats:
    scaled = train.scaled(coordinates.scales(theta)).pick(block)
    coefficients = coordinates.coefficients(theta)
    local = coefficients if coefficients.ndim == 1 else coefficients[block]
    found = sensitivity(scaled, coefficients=local, excitations=coordinates.excitations(theta))
    slope = (
        phasor_jacobian(coordinates, theta, found, coefficients=coefficients, direction=scaled.direction, block=block)
        / coordinates.unit[:, None, None]
    )
    amplitude = np.abs(found.phasor)
    error = error_size(identification.noise, amplitude, np.full(amplitude.shape, np.nan))
    weighted = slope * np.divide(np.sqrt(2.0), error, out=np.zeros_like(error), where=error > 0.0)
    return np.moveaxis(np.stack([weighted.real, weighted.imag]), (0, 1), (-2, -1))


def _greedy(
    rows: list[Floats], identification: Identification, count: int, targets: Sequence[str] | None
) -> list[tuple[int, float, Floats]]:
    """Choose the best candidates one after the other: (candidate, shrinkage, standard errors afterwards)."""
    unknown = [name for name in targets or () if name not in identification.coordinates]
    if unknown:
        raise ValueError(f"not among the identification's coordinates: {', '.join(unknown)}")
    names = identification.coordinates
    which = np.array([targets is None or name in targets for name in names])
    size = np.sqrt(np.diag(identification.covariance))
    # In units of the present standard errors.
    covariance = identification.covariance / np.outer(size, size)
    candidates = {k: one.reshape(-1, one.shape[-1]) * size for k, one in enumerate(rows)}
    chosen: list[tuple[int, float, Floats]] = []
    for _ in range(min(count, len(rows))):
        after = {k: _updated(covariance, one) for k, one in candidates.items()}
        gain = {k: float(np.mean(np.log(np.diag(one)[which]))) for k, one in after.items()}
        best = min(gain, key=lambda k: gain[k])
        before = float(np.mean(np.log(np.diag(covariance)[which])))
        covariance = after[best]
        chosen.append((best, float(np.exp((gain[best] - before) / 2)), size * np.sqrt(np.diag(covariance))))
        del candidates[best]
    return chosen


def _updated(covariance: Floats, rows: Floats) -> Floats:
    """Compute (C⁻¹ + JᵀJ)⁻¹; for few rows by Woodbury's identity."""
    if len(rows) >= len(covariance):
        return np.asarray(np.linalg.inv(np.linalg.inv(covariance) + rows.T @ rows))
    spread = covariance @ rows.T
    return np.asarray(covariance - spread @ np.linalg.solve(np.eye(len(rows)) + rows @ spread, spread.T))
