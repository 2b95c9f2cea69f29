"""Tests that what is cached is what would be computed, for the very same objects only, and not for ever."""

import numpy as np

from estimator.machine.document import Machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.identity_cache import CACHE_SIZE, cached_by_identity, cached_without_probes
from tests.identification import chapter_3


class CountedFunction:
    """A function of objects that says how often it was computed."""

    def __init__(self) -> None:
        self.calls = 0

    def __call__(self, first: object, second: object) -> tuple[object, object]:
        self.calls += 1
        return first, second


def test_the_same_objects_are_computed_once_and_equal_ones_again() -> None:
    counted = CountedFunction()
    asked = cached_by_identity(counted.__call__)
    one, equal, other = [1], [1], [2]
    assert asked(one, other) is asked(one, other)
    assert counted.calls == 1
    assert asked(equal, other)[0] is equal
    assert asked(other, one) == (other, one)
    assert counted.calls == 3


def test_only_the_last_ones_are_kept() -> None:
    counted = CountedFunction()
    asked = cached_by_identity(counted.__call__)
    several = [[number] for number in range(CACHE_SIZE + 1)]
    for one in [*several, several[0]]:
        asked(one, one)
    assert counted.calls == CACHE_SIZE + 2


def test_a_changed_copy_of_a_machine_is_another_one_and_nobody_changes_what_is_kept() -> None:
    machine = chapter_3()
    (name,) = machine.materials
    stiff = machine.materials[name].model_copy(update={"young_modulus": 2.0 * machine.materials[name].young_modulus})
    stiffer = machine.model_copy(update={"materials": {name: stiff}})
    before = assemble_rotor(machine).materials[name].stiffness.copy()
    assert (assemble_rotor(stiffer).materials[name].stiffness == 2.0 * before).all()
    assert not assemble_rotor(machine).materials[name].stiffness.flags.writeable
    assert not assemble_rotor(machine).discs.mass.flags.writeable
    speed = np.array([100.0, 200.0])
    condense(machine, speed=speed, direction=np.ones(2)).known[:] = 0.0
    assert (assemble_rotor(machine).materials[name].stiffness == before).all()


def test_what_probes_do_not_change_is_computed_once_for_a_machine_and_its_copy_with_other_probes() -> None:
    machine = chapter_3()
    asked: list[Machine] = []

    @cached_without_probes
    def answer(machine: Machine) -> int:
        asked.append(machine)
        return len(asked)

    exact = machine.model_copy(update={"probes": machine.probes[:1]})
    turning = machine.model_copy(update={"rotation": "negative"})
    assert [answer(machine), answer(exact), answer(machine), answer(turning)] == [1, 1, 1, 2]
    assert asked == [machine, turning]
