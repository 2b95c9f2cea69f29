"""Runs of machines whose oil follows an operating condition: identified, and restored as models, as they were measured."""

from typing import Any

import numpy as np
import pytest
import yaml
from msgspec.structs import replace

from estimator.fit.identification import Options
from estimator.machine.document import Machine, parse_machine
from estimator.machine.film_parameter_names import LOAD_BALANCE
from estimator.machine.under_conditions import ConditionImpossible, under_conditions
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from service.identification import computation
from service.identification.stored_model import identified
from service.identification.task import IdentificationOutcome, IdentificationTask
from storage.database.engine import Database
from storage.encoding.sample_blocks import encode
from storage.machines import machines
from tests.identification import forward_samples
from tests.paths import EXAMPLES
from tests.plant import store_identification

STATED, MEASURED = 50.0, 65.0
"""Temperature of the oil in the document, and during the run [degC]: at the second it has not much more than half the
viscosity."""


@pytest.fixture(scope="module")
def train() -> Machine:
    """The motor and compressor, with oil whose temperature is measured."""
    said: dict[str, Any] = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    said["conditions"] = [{"name": "oil", "unit": "degC"}]
    for bearing in said["bearings"]:
        bearing["film"]["oil"] = {"iso_vg": 46, "temperature_c": STATED, "temperature_from": "oil"}
    return parse_machine(said)


def computed(train: Machine, *, told: float) -> IdentificationOutcome:
    """The outcome of a run-down with oil of `MEASURED` degrees. told: what the samples say [degC]."""
    rng = np.random.default_rng(3)
    seconds, speed = speed_law(train, "run-down", duration=300.0, samples=120)
    warm = under_conditions(train, {"oil": MEASURED})
    phasor = measured_phasors(warm, draw_truth(warm, rng), speed, rng)
    held = replace(forward_samples(seconds * 1e9, speed, phasor), conditions=np.full((speed.size, 1), told))
    task = IdentificationTask(train.model_dump(mode="json"), [encode(held)], Options(starts=1), 120.0)
    return computation.compute(task)


def viscosities(outcome: IdentificationOutcome) -> list[float]:
    """The viscosities that were found [Pa s]."""
    assert outcome.identification is not None
    found = [outcome.identification.estimate(f"bearing.{one}.viscosity").value for one in ("B1", "B2", "B3", "B4")]
    return [value for value in found if value is not None]


def test_a_run_is_identified_with_its_own_temperature_of_the_oil(train: Machine) -> None:
    outcome = computed(train, told=MEASURED)
    assert outcome.identification is not None
    assert outcome.identification.accepted, outcome.identification.verdict
    assert outcome.load_balance == LOAD_BALANCE
    assert outcome.conditions == {"oil": MEASURED}
    assert outcome.underived is None
    # ISO VG 46 of 65 degC by the law of Walther, and a spread of the truth of 15 %.
    assert viscosities(outcome) == pytest.approx([0.0145] * 4, rel=0.35)


def test_a_temperature_that_is_said_wrong_is_not_taken_for_the_documents(train: Machine) -> None:
    with pytest.raises(ConditionImpossible, match="operating condition 'oil' is 650 °C"):
        computed(train, told=650.0)


def test_a_temperature_that_was_sent_in_fahrenheit_is_named_and_nothing_is_identified(train: Machine) -> None:
    (film, *_) = (one.film for one in train.bearings if one.film is not None)
    assert film.oil.temperature_c is not None
    with pytest.raises(ConditionImpossible, match="were °F sent"):
        computed(train, told=1.8 * film.oil.temperature_c + 32.0)


def test_a_stored_model_has_the_conditions_of_its_runs(database: Database, train: Machine) -> None:
    outcome = computed(train, told=MEASURED)
    assert outcome.identification is not None
    with database.transaction() as session:
        machines.create(session, train)
        row = store_identification(session, outcome.identification, run_id=1, machine_id=train.id)
        row.conditions = outcome.conditions
        session.flush()
        found = identified(session, row.id)
    assert [one.film.oil.temperature_c for one in found.machine.bearings if one.film is not None] == [MEASURED] * 4
