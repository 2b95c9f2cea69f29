"""Tests that what a worker derives never costs the identification, whatever goes wrong with it."""

import signal
from collections.abc import Callable

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.slow_roll import SlowRoll
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from formats.files.document_files import read_machine
from service.identification import computation
from service.identification.task import IdentificationOutcome, IdentificationTask
from storage.encoding.sample_blocks import encode
from tests.identification import forward_samples
from tests.paths import EXAMPLES
from tests.plant import START
from tests.slow_roll import RUN_OUT, with_run_out


@pytest.fixture(scope="module")
def train() -> Machine:
    return read_machine(EXAMPLES / "thesis-chapter-3.yaml")


def computed(train: Machine, *, told: Machine | None = None) -> IdentificationOutcome:
    """The outcome of a simulated run-down of the train. told: another document that the worker is given."""
    rng = np.random.default_rng(1)
    seconds, speed = speed_law(train, "run-down", duration=300.0, samples=100)
    phasor = measured_phasors(train, draw_truth(train, rng), speed, rng)
    held = forward_samples(seconds * 1e9, speed, phasor)
    document = (told or train).model_dump(mode="json")
    return computation.compute(IdentificationTask(document, [encode(held)], Options(starts=1), 60.0))


def test_an_accepted_identification_has_derived_quantities(train: Machine) -> None:
    outcome = computed(train)
    assert outcome.identification is not None
    assert outcome.identification.accepted
    assert outcome.underived is None
    assert {"critical_speed.1", "damping_ratio.1", "splitting.1-3", "coupling.C1.misalignment_moment"} <= {
        one.name for one in outcome.derived
    }
    assert outcome.conditions == {}


def test_one_that_is_not_accepted_has_none(train: Machine) -> None:
    outcome = computed(train, told=train.model_copy(update={"noise": Noise(relative=3e-3)}))
    assert outcome.identification is not None
    assert not outcome.identification.accepted
    assert (outcome.derived, outcome.underived) == ((), None)


def _slow(*_: object, **__: object) -> None:
    signal.raise_signal(signal.SIGALRM)  # as the timer does when the time is up


def _broken(*_: object, **__: object) -> None:
    raise np.linalg.LinAlgError("Singular matrix")


@pytest.mark.parametrize(
    ("fault", "said"),
    [(_broken, "LinAlgError: Singular matrix"), (_slow, "OutOfTime: the identification took longer than allowed")],
    ids=["broken", "slow"],
)
def test_the_identification_stands_without_them(
    train: Machine, monkeypatch: pytest.MonkeyPatch, fault: Callable[..., None], said: str
) -> None:
    monkeypatch.setattr(computation, "derived_quantities", fault)
    outcome = computed(train)
    assert outcome.identification is not None
    assert outcome.identification.accepted
    assert (outcome.derived, outcome.underived) == ((), said)


def test_the_quality_of_a_run_tells_of_swapped_channels_and_its_fit_is_without_the_slow_roll(train: Machine) -> None:
    seconds, speed, phasor = with_run_out(train, duration=3000.0, samples=40)
    held = forward_samples(START + seconds * 1e9, speed, phasor[:, [0, 1, 3, 2, 4, 5, 6, 7]])
    vectors = SlowRoll(1, RUN_OUT, np.full(8, 1e-6))
    task = IdentificationTask(train.model_dump(mode="json"), [encode(held)], Options(starts=1), 60.0, slow_roll=vectors)
    outcome = computation.compute(task)
    assert any("the orbit at B2X and B2Y turns backward" in words for words in outcome.qualities[0].findings)
    assert outcome.identification is not None
    assert "probe.B1X.run_out.real" in outcome.identification.coordinates


def test_a_refused_run_tells_of_the_wrong_convention_instead_of_the_wrong_wiring(train: Machine) -> None:
    """Phases sent with the wrong sign turn every orbit backward as well."""
    rng = np.random.default_rng(1)
    seconds, speed = speed_law(train, "run-down", duration=3000.0, samples=40)
    phasor = measured_phasors(train, draw_truth(train, rng), speed, rng)
    held = forward_samples(START + seconds * 1e9, speed, phasor.conj())
    outcome = computation.compute(IdentificationTask(train.model_dump(mode="json"), [encode(held)], Options(starts=1), 60.0))
    assert outcome.identification is not None
    assert not outcome.identification.accepted
    assert (
        "times better with the opposite sign of the phase: lead sent as lag, or lag as lead; "
        in outcome.identification.verdict
    )
    assert not any("sense of rotation" in words or "swapped" in words for words in outcome.qualities[0].findings)


@pytest.mark.parametrize("fault", [_broken, _slow], ids=["broken", "slow"])
def test_what_goes_wrong_with_conventions_never_costs_the_refused_identification(
    train: Machine, monkeypatch: pytest.MonkeyPatch, fault: Callable[..., None]
) -> None:
    monkeypatch.setattr(computation, "with_named_conventions", fault)
    outcome = computed(train, told=train.model_copy(update={"noise": Noise(relative=3e-3)}))
    assert outcome.identification is not None
    assert not outcome.identification.accepted
