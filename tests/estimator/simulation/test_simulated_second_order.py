"""2× of simulated machines: a stated part of the 1×, larger beside a coupling that goes out of alignment and nowhere else."""

import numpy as np
import pytest
import yaml

from estimator.machine.document import Machine, parse_machine
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_second_order import MISALIGNED_PART, PART, second_parts, simulated_second
from tests.paths import EXAMPLES


@pytest.fixture
def pump() -> Machine:
    """The motor and pump of the examples."""
    return parse_machine(yaml.safe_load((EXAMPLES / "motor-pump.yaml").read_text(encoding="utf-8")))


def test_it_grows_beside_a_misaligned_coupling_only(pump: Machine) -> None:
    parts = dict(zip(pump.channels, second_parts(pump, "misalignment", 1.0), strict=True))
    grown = {one for one, part in parts.items() if part == pytest.approx(MISALIGNED_PART)}
    assert grown
    assert {part for one, part in parts.items() if one not in grown} == {PART}
    assert len(grown) < len(parts)


@pytest.mark.parametrize(("scenario", "progress"), [("healthy", 1.0), ("unbalance", 1.0), ("misalignment", 0.0)])
def test_it_stays_where_nothing_is_misaligned(pump: Machine, scenario: Scenario, progress: float) -> None:
    assert second_parts(pump, scenario, progress) == pytest.approx(PART)


def test_it_is_its_part_of_the_1x_and_keeps_its_place_in_the_turn(pump: Machine) -> None:
    channels = len(pump.channels)
    first = 80e-6 * np.exp(1j * np.linspace(0.0, 5.0, 400))[:, None] * np.ones(channels)
    phases = np.linspace(0.0, 3.0, channels)
    parts = second_parts(pump, "healthy", 0.0)
    second = simulated_second(pump, first, parts=parts, phases=phases, rng=np.random.default_rng(1))
    over = second / (np.abs(first) * np.exp(2j * np.angle(first)))
    assert over.mean(axis=0) == pytest.approx(PART * np.exp(1j * phases), abs=0.002)
    assert np.all(over.std(axis=0) > 0.0), "it has the noise of the document"
