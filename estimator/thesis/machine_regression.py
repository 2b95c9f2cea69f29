"""Identification of the thesis's Chapter 4 on a machine's own run, as published, to compare with the maximum-likelihood fit.

High-frequency condensation to the bearings' translations and a least-squares regression (Eq. 4.54-4.57, 4.71). It has no
intervals, is biased by noise in the regressors and wrong at speeds where stiffness matters: see the evidence page.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.arrays import Complexes, Floats
from estimator.machine.document import Machine
from estimator.machine.parameter_description import is_direct
from estimator.phasors.measurement import Measurement
from estimator.phasors.noise import error_size
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.rotor.shaft_element import NODE_DOFS
from estimator.thesis.flexible_train import flexible_train
from estimator.thesis.parameter_rules import RegularisationRule
from estimator.thesis.reduced_model import response_equations
from estimator.thesis.reduction import high_frequency_condensed
from estimator.thesis.regression import Scaling, Solution, solve
from estimator.thesis.response_regression import speed_independent_regression, with_trial_unbalances


@dataclass(frozen=True)
class PublishedEstimate:
    """Estimate of C real unknowns by the published method.

    Attributes:
        names: Names of the unknowns, real and imaginary part of each unbalance apart.
        units: Units of the unknowns.
        solution: Their values.
        reduced_chi_square: χ² per degree of freedom of the measured phasors against the response of the machine with these
            values, by its noise model [-]; about 1 if they explain the run.
        impossible: Direct terms that came out zero or negative.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    solution: Solution
    reduced_chi_square: float
    impossible: tuple[str, ...]


class NotMeasuredAtBearings(ValueError):
    """Raised when a bearing's two translations are not measured, which the method needs at every speed."""


def regress(
    machine: Machine, measurement: Measurement, *, scaling: Scaling = "norm", tikhonov: RegularisationRule | None = None
) -> PublishedEstimate:
    """Identify as Chapter 4 of the thesis does (Eq. 4.54-4.57, 4.71).

    Args:
        machine: The machine.
        measurement: Phasors of its run.
        scaling: Scaling of the regression's columns.
        tikhonov: Rule for a regularisation that draws towards the nominal values (§6.5); None for none.

    Returns:
        The estimate.

    Raises:
        NotMeasuredAtBearings: A bearing lacks two probes at different angles.
        ValueError: The equations are fewer than the unknowns or do not contain one.
    """
    translations, used = bearing_translations(machine, measurement)
    train = flexible_train(machine)
    speed, direction = measurement.speed[used], measurement.direction[used]
    model = high_frequency_condensed(train, speed=speed, direction=direction)
    equations = response_equations(model, translations[used])
    if measurement.added is not None:
        equations = with_trial_unbalances(equations, measurement.added[used])
    mean_speed = float(np.mean(speed))
    regression = speed_independent_regression(equations, train.unknowns, mean_speed=mean_speed, damping_scaled=True)
    coefficients, planes = train.unknowns.coefficients, train.unknowns.unbalances
    nominal = np.array([plane.nominal or 0j for plane in planes])
    parts = np.stack([nominal.real, nominal.imag], axis=-1).reshape(-1)
    expected = np.concatenate([[one.expected for one in coefficients], parts])
    units = [one.unit for one in coefficients] + [plane.unit for plane in planes for _ in (0, 1)]
    solution = solve(regression, scaling=scaling, tikhonov=tikhonov, expected=expected)
    count = len(coefficients)
    impossible = tuple(n for n, value in zip(regression.names, solution.values, strict=True) if is_direct(n) and value <= 0.0)
    return PublishedEstimate(
        names=regression.names,
        units=tuple(units),
        solution=solution,
        reduced_chi_square=_reduced_chi_square(machine, measurement, solution.values[:count], solution.values[count:]),
        impossible=impossible,
    )


def _reduced_chi_square(machine: Machine, measurement: Measurement, coefficients: Floats, parts: Floats) -> float:
    """Compute the distance of the whole machine with these values from the run, per measured number beyond the unknowns."""
    train = condense(machine, speed=measurement.speed, direction=measurement.direction)
    own = parts.reshape(-1, 2) @ np.array([1.0, 1.0j])
    excitations = np.zeros((measurement.speed.size, len(train.unknowns.excitations)), dtype=complex)
    excitations[:, : own.size] = own
    if measurement.added is not None:
        excitations[:, : measurement.added.shape[1]] += measurement.added
    modelled = response(train, coefficients=coefficients, excitations=excitations)
    error = error_size(machine.noise, np.abs(measurement.phasor), measurement.scatter)
    used = measurement.usable & (error > 0.0)
    square = np.abs(measurement.phasor - modelled)[used] ** 2 / error[used] ** 2
    return float(2.0 * square.sum() / max(1, 2 * square.size - coefficients.size - parts.size))


def bearing_translations(machine: Machine, measurement: Measurement) -> tuple[Complexes, NDArray[np.bool_]]:
    """Compute the translations along x and y at the bearings, as `FlexibleTrain.bearing` orders them.

    Source: standard result: least squares of x cos β + y sin β.

    Args:
        machine: The machine.
        measurement: S samples of its channels.

    Returns:
        Translations (S, n) [m], and which samples are usable (S,).

    Raises:
        NotMeasuredAtBearings: Bearings lack two probes at different angles; the error names them.
    """
    rotor = assemble_rotor(machine)
    at_node: dict[int, list[int]] = {}
    for channel, probe in enumerate(machine.probes):
        at_node.setdefault(rotor.node(probe.shaft, probe.station), []).append(channel)
    angle = np.deg2rad([probe.angle_deg for probe in machine.probes])
    lacking = []
    for bearing in machine.bearings:
        seen = at_node.get(rotor.node(bearing.shaft, bearing.station), [])
        if len(seen) < 2 or np.ptp(np.sin(angle[seen] - angle[seen[0]])) < 1e-3:
            lacking.append(bearing.id)
    if lacking:
        raise NotMeasuredAtBearings(f"each bearing needs two probes at different angles; missing at {', '.join(lacking)}")
    degrees = flexible_train(machine).bearing
    found = np.zeros((measurement.speed.size, degrees.size), dtype=complex)
    used = np.ones(measurement.speed.size, dtype=bool)
    phasor = np.where(measurement.usable, measurement.phasor, 0.0)
    for column, degree in enumerate(degrees):
        channels = at_node[degree // NODE_DOFS]
        rows = np.stack([np.cos(angle[channels]), np.sin(angle[channels])], axis=1)
        found[:, column] = phasor[:, channels] @ np.linalg.pinv(rows)[degree % NODE_DOFS]
        used &= measurement.usable[:, channels].all(axis=1)
    return found, used
