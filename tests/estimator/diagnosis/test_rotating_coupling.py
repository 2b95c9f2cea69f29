"""The run-out of a coupling among everything else that can have happened to a constant train: named where it is there."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.arrays import Complexes
from estimator.diagnosis.finding_kind import BaselineValues, Cause
from estimator.diagnosis.finding_kinds import finding_kind
from estimator.diagnosis.observation import with_common_errors
from estimator.diagnosis.run_windows import RunWindows
from estimator.machine.parts import RotatingError
from estimator.rotor.condensation import condense
from estimator.rotor.response import excitation_responses
from estimator.simulation.simulated_plant import speed_law
from tests.estimator.diagnosis import watched_machine as plant

OURS = ("rotating_coupling", "coupling.C1")
OFFSET = 3e-6 * np.exp(0.7j)


def turning(offset: complex, angle: complex) -> plant.Edit:
    """Return what the pull of a coupling's run-out adds to the phasors, its truth's coefficients taken as they are."""
    machine = plant.motor_pump()
    couplings = (machine.couplings[0].model_copy(update={"rotating_error": RotatingError()}),)
    described = machine.model_copy(update={"couplings": couplings})
    _, speed = speed_law(machine, "run-down", duration=1200.0, samples=plant.SAMPLES)
    train = condense(described, speed=speed, direction=np.full(speed.size, float(machine.direction)))
    each = excitation_responses(train, coefficients=plant.true_machine().coefficients)[-4:]
    parts = np.array([offset.real, offset.imag, angle.real, angle.imag])

    def edit(phasor: Complexes, _rng: np.random.Generator) -> None:
        phasor += np.tensordot(parts, each, 1)

    return edit


def found(edit: plant.Edit) -> tuple[Cause, ...]:
    return plant.watch().found(plant.after(plant.true_machine(), edit=edit), on_delay=plant.delay(2)).causes


def named(causes: tuple[Cause, ...]) -> set[tuple[str, str]]:
    return {(one.kind, one.element) for one in causes}


@pytest.mark.parametrize(
    ("offset", "angle"),
    [(OFFSET, 0j), pytest.param(OFFSET, 2e-4j, marks=pytest.mark.long), pytest.param(2e-5j, 0j, marks=pytest.mark.long)],
)
def test_a_run_out_of_bore_and_face_is_named_and_neither_an_unbalance_nor_a_bow(offset: complex, angle: complex) -> None:
    causes = found(turning(offset, angle))
    assert named(causes) == {OURS}
    values = BaselineValues(dict.fromkeys(causes[0].names, 0.0), {})
    size = finding_kind("rotating_coupling").size
    assert size is not None
    told = size(causes[0], values).quantities
    assert told["offset_um"] == pytest.approx(1e6 * abs(offset), rel=0.25)
    assert told["offset_deg"] == pytest.approx(np.degrees(np.angle(offset)), abs=15.0)


def test_an_unbalance_is_no_run_out_of_a_coupling() -> None:
    unbalanced = plant.watch().found(plant.after(plant.grown({}, {0: 1.5})), on_delay=plant.delay(2)).causes
    assert {kind for kind, _ in named(unbalanced)} == {"unbalance"}


def test_a_probes_run_out_and_gain_are_no_run_out_of_a_coupling() -> None:
    assert OURS not in named(found(plant.run_out(2, 2e-5)))
    assert OURS not in named(found(plant.gain(2, 1.1)))


def test_fits_of_an_older_release_that_say_nothing_of_it_are_compared_without_it() -> None:
    """A baseline of that release: the newest runs are looked at with what both say."""
    baseline = plant.watch().baseline
    kept = [name for name in baseline[0].names if "rotating" not in name]
    assert len(kept) == len(baseline[0].names) - 4
    older = [one.with_errors_of(kept) for one in baseline]
    watch = RunWindows.from_baseline(plant.motor_pump(), older)
    unbalanced = plant.after(plant.grown({}, {0: 1.5}))
    assert {one.kind for one in watch.found(unbalanced, on_delay=plant.delay(2)).causes} == {"unbalance"}
    assert {one.kind for one in watch.found(plant.healthy(2), on_delay=plant.delay(2)).causes} == set()
    mixed = with_common_errors([*older[:3], *baseline[3:]])
    assert {one.names for one in mixed} == {tuple(kept)}


def test_observations_that_lack_something_are_left_as_they_are() -> None:
    one = plant.watch().baseline[0]
    assert one.with_errors_of(one.names) is one
    assert one.with_errors_of([*one.names, "coupling.C9.rotating_offset.real"]) is one
    assert replace(one).with_errors_of(one.names[:3]).names == one.names
