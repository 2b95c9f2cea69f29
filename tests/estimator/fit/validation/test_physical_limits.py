"""Models that no machine can have: refused, or brought to where nothing grows when the data allow that as well."""

import numpy as np
import pytest

from estimator.fit.identify import identify
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.validation.physical_limits import LeastDampedMode, PhysicalLimits
from estimator.machine.document import Machine, parse_machine
from estimator.modes.eigenmodes import eigenvalues
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.statics.equilibrium import film_train
from estimator.statics.film_stability import least_damped_whirl
from tests.estimator.statics.test_film_model import document
from tests.estimator.statics.test_tilting_fit import example
from tests.estimator.trains import Floats, chapter_3_document, dense_response, noisy

SPEED: Floats = np.arange(4.0, 300.0, 4.0)


def whirling(cross: float) -> Machine:
    """Chapter 3 with a cross-coupled stiffness of this part of the direct one, as a film has it: kxy = -kyx."""
    document = chapter_3_document()
    for bearing in document["bearings"]:
        bearing["kxy"], bearing["kyx"] = cross * bearing["kxx"], -cross * bearing["kxx"]
    return parse_machine(document)


def limits_of(machine: Machine) -> tuple[PhysicalLimits, Coordinates]:
    train = condense(machine, speed=SPEED, direction=np.ones(SPEED.size))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    return PhysicalLimits(machine, SPEED, coordinates, tuple(train.scale_names)), coordinates


def test_least_damped_mode_is_that_of_the_whole_eigenproblem() -> None:
    machine = whirling(0.3)
    limits, coordinates = limits_of(machine)
    (found,) = limits.least_damped(coordinates.centre)
    solved = eigenvalues(machine, spin=SPEED[-1])
    slow = solved[solved.imag < 2.0 * SPEED[-1]]
    assert found.damping_ratio == pytest.approx(np.min(-slow.real / np.abs(slow)), rel=1e-9)


def test_slopes_are_those_of_differences() -> None:
    limits, coordinates = limits_of(whirling(0.3))
    theta = coordinates.centre
    (mode,) = limits.least_damped(theta)
    slopes = limits.slopes(theta, mode)
    for place in np.argsort(np.abs(slopes))[-6:]:
        values = []
        for change in (-1e-5, 1e-5):
            moved = theta.copy()
            moved[place] += change
            values.append(limits.least_damped(moved)[0].eigenvalue.real)
        assert slopes[place] == pytest.approx((values[1] - values[0]) / 2e-5, rel=1e-4)


def test_slopes_by_the_numbers_of_films_are_those_of_differences() -> None:
    machine = parse_machine(document(discrepancy=0.05))
    speed = np.linspace(80.0, 450.0, 20)
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    limits, theta = PhysicalLimits(machine, speed, coordinates, ()), coordinates.centre
    modes = limits.least_damped(theta)
    number = int(np.argmin([one.damping_ratio for one in modes]))
    slopes = limits.slopes(theta, modes[number])
    for place in np.argsort(np.abs(slopes))[-12:]:
        values = []
        for change in (-1e-4, 1e-4):
            moved = theta.copy()
            moved[place] += change
            values.append(limits.least_damped(moved)[number].eigenvalue.real)
        assert slopes[place] == pytest.approx((values[1] - values[0]) / 2e-4, rel=1e-3)


def test_pads_that_tilt_are_degrees_of_freedom_of_their_own() -> None:
    """Modes are those of the train with its pads; by deviations, which leave the pads as they are, slopes are exact."""
    machine = example()
    speed = np.linspace(100.0, 780.0, 20)
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    coordinates = Coordinates.of(train, unbalance_scale=1.0)
    limits, theta = PhysicalLimits(machine, speed, coordinates, ()), coordinates.centre
    films, found = film_train(machine), limits.least_damped(theta)
    for one in found[-2:]:  # at lower speeds a mode above those of interest to whirl is damped least
        equilibrium = films.equilibrium(one.speed)
        assert equilibrium is not None
        alone = least_damped_whirl(machine, equilibrium)
        assert alone is not None
        assert one.eigenvalue.imag == pytest.approx(alone.frequency, rel=1e-4)
        assert -2.0 * np.pi * one.eigenvalue.real / one.eigenvalue.imag == pytest.approx(alone.log_decrement, rel=1e-3)
    mode = min(found, key=lambda one: one.damping_ratio)
    slopes, number = limits.slopes(theta, mode), found.index(mode)
    deviations = [place for place, name in enumerate(coordinates.names) if "_deviation" in name]
    for place in sorted(deviations, key=lambda one: -abs(slopes[one]))[:4]:
        values = []
        for change in (-1e-3, 1e-3):
            moved = theta.copy()
            moved[place] += change
            values.append(limits.least_damped(moved)[number].eigenvalue.real)
        assert slopes[place] == pytest.approx((values[1] - values[0]) / 2e-3, rel=2e-3)


def test_data_of_a_train_that_whirls_are_refused_with_speed_and_frequency() -> None:
    """The steady response of an unstable model can be computed; no machine shows it."""
    machine = whirling(1.5)
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(dense_response(machine, SPEED, direction=1), seed=0)))
    assert not found.accepted
    assert found.verdict.startswith("not physically possible: at 2827 r/min, where the machine ran, a mode of ")


def test_a_stable_train_is_accepted_as_before() -> None:
    machine = whirling(0.1)
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(dense_response(machine, SPEED, direction=1), seed=0)))
    assert found.accepted, found.verdict
    assert "physically" not in found.verdict


def test_a_mode_that_does_not_oscillate_is_reported_in_its_own_words() -> None:
    assert "leaves its bearings" in LeastDampedMode(100.0, 3.0 + 0.0j).words
