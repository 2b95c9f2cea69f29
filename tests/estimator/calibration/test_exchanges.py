"""Probes or weights that are exchanged in the runs of a calibration: named where the runs show it, and never in right ones."""

from collections import Counter
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.calibration.rotor_kit import kit
from benchmarks.calibration.simulated_kit import SimulatedKit
from estimator.calibration.calibrate import SOON, Calibrated, calibrate, with_named_senses
from estimator.calibration.calibration_runs import CalibrationRun
from estimator.calibration.exchanges import CLEAR, Exchange, exchange_text
from estimator.calibration.undetermined import with_free_parameters
from estimator.fit.optimisation.maximum_likelihood import descend
from estimator.machine.document import Machine

MIRRORED = ("P1X, P1Y and P2X, P2Y", "the weights of D1 and D2")


def told(machine: Machine, runs: list[CalibrationRun]) -> Calibrated:
    return with_named_senses(machine, runs, calibrate(machine, runs))


def exchanged(columns: tuple[int, ...] = (0, 1, 2, 3), discs: tuple[int, ...] = (0, 1)) -> Calibrated:
    """Calibrate the measured kit with its probes or weights exchanged."""
    machine, whole, conditions = kit()
    return told(machine, Exchange("", columns, discs).runs([CalibrationRun("kit", whole, conditions, steady=True)]))


def doubts(found: Calibrated) -> list[str]:
    return [one for one in (*found.remarks, found.verdict) if "exchanged" in one]


@pytest.mark.parametrize(
    ("columns", "named"), [((2, 1, 0, 3), "P1X and P2X"), ((0, 3, 2, 1), "P1Y and P2Y"), ((3, 1, 2, 0), "P1X and P2Y")]
)
def test_probes_of_two_planes_that_are_exchanged_are_named(columns: tuple[int, ...], named: str) -> None:
    found = exchanged(columns)
    assert found.accepted
    [doubt] = doubts(found)
    assert f"times better with {named} exchanged" in doubt
    assert found.machine.calibration is not None
    assert doubt in found.machine.calibration.verdict


def test_weights_of_two_discs_that_are_exchanged_are_named_with_what_is_the_same_in_a_mirrored_kit() -> None:
    [doubt] = doubts(exchanged(discs=(1, 0)))
    assert all(words in doubt for words in MIRRORED)


def test_two_probes_of_one_plane_of_a_round_kit_cannot_be_told_apart() -> None:
    found = exchanged((1, 0, 2, 3))
    assert found.accepted
    assert doubts(found) == []


@pytest.mark.parametrize("mountings", [3, pytest.param(8, marks=pytest.mark.long)])
def test_nothing_is_named_in_right_runs(mountings: int) -> None:
    assert doubts(exchanged()) == []
    plant = SimulatedKit(5)
    measured = [plant.run(plant.trial(number)) for number in range(mountings)]
    runs = [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * one.speed.size, steady=True) for k, one in enumerate(measured)]
    assert doubts(told(plant.machine, runs)) == []


def test_a_refused_calibration_says_which_exchange_explains_it() -> None:
    plant = SimulatedKit(0)
    measured = [plant.run(plant.trial(number)) for number in range(8)]
    swapped = [replace(one, added=np.asarray(one.added)[:, ::-1]) for one in measured]
    runs = [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * one.speed.size, steady=True) for k, one in enumerate(swapped)]
    found = told(plant.machine, runs)
    assert not found.accepted
    assert "the weights of D1 and D2" in found.verdict.partition("; the runs fit")[2]


def test_what_cannot_explain_a_refused_calibration_ends_early(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each loaded run has the weights of the next: no sense and no exchange can explain that."""
    plant = SimulatedKit(0)
    weights = [plant.trial(number) for number in range(8)]
    measured = [plant.run(one) for one in weights]
    shifted = [
        measured[0],
        *(replace(a, added=b.added) for a, b in zip(measured[1:], [*measured[2:], measured[1]], strict=True)),
    ]
    runs = [CalibrationRun(f"run-{k}", one, (f"run-{k}",) * one.speed.size, steady=True) for k, one in enumerate(shifted)]
    refused = calibrate(plant.machine, runs)
    assert not refused.accepted
    calls: Counter[str] = Counter()

    def counted(function: Callable[..., Any]) -> Callable[..., Any]:
        def calling(*given: Any) -> Any:
            calls[function.__name__] += 1
            return function(*given)

        return calling

    for function in (descend, with_free_parameters):
        monkeypatch.setattr(f"estimator.calibration.calibrate.{function.__name__}", counted(function))
    assert with_named_senses(plant.machine, runs, refused).verdict == refused.verdict
    tried = calls["with_free_parameters"]
    assert tried > 1
    assert calls["descend"] <= (SOON + 1) * tried


def test_only_what_is_far_likelier_is_said() -> None:
    one, other = (Exchange(words, (1, 0), (0,)) for words in ("A and B", "C and D"))
    assert exchange_text([(one, CLEAR - 0.1)], 100) == ""
    assert exchange_text([], 100) == ""
    both = exchange_text([(other, 68.0), (one, 69.3)], 100)
    assert both.startswith("the runs fit 2.0 times better with A and B or C and D exchanged")
    assert exchange_text([(other, 40.0), (one, 500.0)], 100).startswith("the runs fit 148 times better with A and B exchanged")
    assert exchange_text([(one, 700.0)], 100).startswith("the runs fit over 1000 times better with A and B exchanged")
