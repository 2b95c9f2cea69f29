"""Document for a calibration: what the runs can determine set free, the rest held at the document's values, and said so.

A dwell gives a bearing's terms two real numbers for each of its pairs of axes, and a speed that differs by less than a
hundredth gives the same ones again. So the terms are held where there are fewer speeds than terms.
"""

import numpy as np
from msgspec import structs

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import Machine
from estimator.machine.parameter_description import describe
from estimator.machine.rules import ParameterRule
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense

SAME_SPEED = 0.01
"""Relative difference up to which neighbouring speeds count as one [-]."""
HELD_SPREAD = 0.2
"""Standard deviation by which held terms may still differ from the document, relative [-]."""
HELD_CROSS_SPREAD = 0.05
"""Standard deviation of held cross-coupled terms, as a part of the direct terms beside them [-]: more would let modes grow."""
GAIN_SPREAD = 3.0
"""Spread of a gain before it is calibrated [-]: the chain may be any."""
FREE_GAIN_SPREAD = 100.0
"""Spread of a gain in the fit of a calibration [-]: that of a document would draw all gains together towards one."""
RUN_OUT_PART = 0.3
"""Spread of a run-out before it is calibrated, as a part of the channel's median amplitude [-]."""
MODULUS_SPREAD = 0.2
"""Least relative spread of Young's modulus in a calibration [-]: it stands for joints and stations that are not exact."""


def distinct_speeds(speed: Floats) -> Floats:
    """Return the distinct speeds: those that add information.

    Args:
        speed: Speeds (S,) [rad/s].

    Returns:
        Mean of each cluster of speeds (D,), ascending [rad/s].
    """
    ordered = np.sort(speed)
    apart = np.flatnonzero(np.diff(np.log(ordered)) > SAME_SPEED) + 1
    # A sweep's speeds follow closely, but its ends are not one speed.
    return np.concatenate([_within(one) for one in np.split(ordered, apart)])


def _within(cluster: Floats) -> Floats:
    """Return the speeds (d,) of one cluster [rad/s]: its mean, or as many as fit into a wide one."""
    count = 1 + int(np.log(cluster[-1] / cluster[0]) / (2.0 * SAME_SPEED))
    return np.array([one.mean() for one in np.array_split(cluster, min(count, cluster.size))])


def with_free_parameters(machine: Machine, measurement: Measurement) -> tuple[Machine, tuple[str, ...]]:
    """Return the document that a calibration fits, and say what it holds.

    Args:
        machine: The machine.
        measurement: All samples.

    Returns:
        The machine with gains, run-outs and moduli free and undetermined terms held; what is held, in words.
    """
    machine = _with_free_chains(machine, measurement)
    speeds = distinct_speeds(measurement.speed).size
    train = condense(machine, speed=np.ones(1), direction=np.ones(1))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    ruled = {one.name for one in train.unknowns.coefficients if one.spread is not None}
    free = [one for one in coordinates.parameters if not one.nuisance]
    if speeds >= len(free):
        return machine, ()
    given = {one.name for one in train.unknowns.coefficients if one.nominal is not None}
    held = [one.name for one in free if one.name in given and one.name not in ruled]
    if not held:
        return machine, ()
    direct = {one.name for one in train.unknowns.coefficients if one.direct}
    rules = tuple(ParameterRule(names=name, spread=HELD_SPREAD if name in direct else HELD_CROSS_SPREAD) for name in held)
    kinds = sorted({describe(name).element_kind for name in held})
    words = (
        f"{_count(speeds, 'speed')} cannot determine {_count(len(held), ' and '.join(kinds) + ' term')}: held at the "
        f"document's values, within {100 * HELD_SPREAD:.0f} %"
    )
    return machine.model_copy(update={"parameters": (*machine.parameters, *rules)}), (words,)


def with_free_gains(coordinates: Coordinates) -> Coordinates:
    """Return coordinates in which nothing draws the gains towards one.

    Few weights leave a factor on all gains open by some per cent, and each channel's prior draws at this one factor.

    Args:
        coordinates: The coordinates of a calibration.

    Returns:
        The same ones, with gains that may be any.
    """
    first = coordinates.channels.gain[coordinates.channels.gain >= 0]
    spread = coordinates.spread.copy()
    spread[np.concatenate([first, first + 1])] = FREE_GAIN_SPREAD
    return structs.replace(coordinates, spread=spread)


def _with_free_chains(machine: Machine, measurement: Measurement) -> Machine:
    amplitude = np.where(measurement.usable, np.abs(measurement.phasor), np.nan)
    typical = [float(np.nanmedian(column)) if np.isfinite(column).any() else 0.0 for column in amplitude.T]
    probes = tuple(
        probe.model_copy(
            update={
                "gain_spread": max(probe.gain_spread, GAIN_SPREAD),
                "run_out_spread": max(probe.run_out_spread, RUN_OUT_PART * size),
            }
        )
        for probe, size in zip(machine.probes, typical, strict=True)
    )
    used = {section.material for shaft in machine.shafts for section in shaft.sections}
    materials = {
        name: one.model_copy(update={"young_modulus_spread": max(one.young_modulus_spread, MODULUS_SPREAD)})
        if name in used
        else one
        for name, one in machine.materials.items()
    }
    return machine.model_copy(update={"probes": probes, "materials": materials, "calibration": None})


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"
