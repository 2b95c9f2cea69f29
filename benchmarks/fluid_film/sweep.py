"""Correction of a sweep on a film train, against an integration in time."""

import time

import numpy as np

from benchmarks.fluid_film.report_line import ReportLine
from estimator.fit.problem.coordinates import Coordinates
from estimator.identification.sweep_correction import predicted_transient
from estimator.machine.document import Machine
from estimator.rotor.condensation import condense
from estimator.updated_model.model import UpdatedModel, model_at
from tests.film_plant.documents import linear_machine
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.plants import motor_compressor_plant
from tests.film_plant.scores import true_values

RATES_RPM_PER_S = (20.0, 80.0)
FOLLOWED_KNOTS = 12
"""Number of knots by which a model follows a film's coefficients in the sweep: the most that a document takes."""
CLEAR = 0.01
"""Part of the amplitude from which on a deviation counts [-]."""


def sweep(_: int) -> list[ReportLine]:
    """Return the error of the sweep correction against an integration in time, as a part of the deviation."""
    found = []
    plant = motor_compressor_plant(1, "flexible")
    knots = np.linspace(plant.slowest / RPM, plant.fastest / RPM, FOLLOWED_KNOTS)
    machine = linear_machine(plant, form="piecewise", knots_rpm=knots.tolist(), terms="all", perturbation=0.0)
    model = _film_model(machine, plant)
    for rate in RATES_RPM_PER_S:
        record = plant.swept(rate_rpm_per_s=rate, samples=150)
        true = record.instant - record.steady
        began = time.perf_counter()
        predicted = predicted_transient(model, time=record.time, speed=record.speed).instant
        took = time.perf_counter() - began
        clear = np.abs(true) > CLEAR * np.abs(record.steady)
        wrong = float(np.sqrt(np.sum(np.abs(predicted - true) ** 2) / np.sum(np.abs(true) ** 2)))
        size = f"{100 * wrong:.1f} % in {took:.2f} s"
        what = (
            f"sweep correction at {rate:.0f} r/min per s, rms over that of the deviation "
            f"({np.mean(clear):.1%} above {CLEAR:.0%})"
        )
        found.append(ReportLine(what, "<= 10 %", size, wrong <= 0.1))
    return found


def _film_model(machine: Machine, plant: Plant) -> UpdatedModel:
    """Return the model of a document with many knots at the plant's own coefficients and unbalances."""
    coordinates = Coordinates.of(condense(machine, speed=np.ones(1), direction=np.ones(1)), unbalance_scale=1.0)
    truth, theta = true_values(plant, machine), coordinates.centre.copy()
    for place, one in enumerate(coordinates.parameters):
        theta[place] = one.fitted(truth[one.name].real) if one.name in truth else one.centre
    for disc, first in zip(plant.train.discs, coordinates.excitation_place, strict=False):
        theta[first], theta[first + 1] = disc.unbalance.real, disc.unbalance.imag
    return model_at(machine, coordinates.names, coordinates.point(theta))
