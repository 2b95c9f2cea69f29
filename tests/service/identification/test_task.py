"""What a worker derives never costs the identification, whatever goes wrong with it."""

import signal
from collections.abc import Callable

import numpy as np
import pytest

from estimator.fit.identify import Options
from estimator.machine.document import Machine
from estimator.machine.rules import Noise
from estimator.phasors.channel_status import ChannelStatus
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from service.configuration.document_files import read_machine
from service.identification import computation
from service.identification.task import IdentificationOutcome, IdentificationTask
from storage.encoding.sample_blocks import Samples, encode
from tests.paths import EXAMPLES


@pytest.fixture(scope="module")
def train() -> Machine:
    return read_machine(EXAMPLES / "thesis-chapter-3.yaml")


def computed(train: Machine, *, told: Machine | None = None) -> IdentificationOutcome:
    """The outcome of a simulated run-down of the train. told: another document that the worker is given."""
    rng = np.random.default_rng(1)
    seconds, speed = speed_law(train, "run-down", duration=300.0, samples=100)
    phasor = measured_phasors(train, draw_truth(train, rng), speed, rng)
    held = Samples(
        time=(seconds * 1e9).astype(np.int64),
        speed=speed,
        direction=np.ones(speed.size, np.int8),
        phasor=phasor,
        status=np.full(phasor.shape, ChannelStatus.GOOD, np.uint8),
        scatter=np.full(phasor.shape, np.nan),
        second=np.full(phasor.shape, complex(np.nan, np.nan)),
    )
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
