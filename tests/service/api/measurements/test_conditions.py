"""Operating conditions from a source to the answers of the API: stored with the samples, told with them, and with runs."""

from collections.abc import Iterator

import httpx
import pytest

from benchmarks.serving import served
from service.runs.collector import Collector
from storage.database.engine import Database
from storage.machines import machines
from storage.measurements import quarantine
from tests.plant import START, arrived, batch, identification, machine, store_identification
from tests.prompt_writer import PromptWriter

CONDITIONS = [{"name": "oil", "unit": "degC"}, {"name": "load", "unit": "%"}]


@pytest.fixture
def warm(plant: Database) -> PromptWriter:
    """A sample writer of a machine whose newest revision names two conditions; two samples came under the one before."""
    writer = PromptWriter(plant, Collector())
    writer.store([arrived(batch([900.0, 901.0]))], [])
    with plant.transaction() as session:
        machines.revise(session, machine(conditions=CONDITIONS))
    return writer


@pytest.fixture
def api(plant: Database) -> Iterator[httpx.Client]:
    with served(plant) as url, httpx.Client(base_url=url) as client:
        yield client


def test_conditions_are_reported_with_the_samples(warm: PromptWriter, api: httpx.Client) -> None:
    told = {"load": [80.0, None, 82.0], "oil": [61.5, 61.25, 61.0]}
    sent = batch([902.0, 903.0, 904.0], sequence=2, start=START + 2 * 10**9, conditions=told)
    outcomes = warm.store([arrived(sent)], [])
    without = batch([905.0], sequence=5, start=START + 5 * 10**9)
    outcomes += warm.store([arrived(without)], [])
    assert [outcome.received for outcome in outcomes] == [3, 1]
    found = api.get("/machines/pump-7/samples").json()
    assert found["conditions"] == {"oil": [61.5, 61.25, 61.0, None], "load": [80.0, None, 82.0, None]}


def test_a_condition_that_no_document_names_is_kept_apart(warm: PromptWriter, plant: Database) -> None:
    (outcome,) = warm.store([arrived(batch([902.0], sequence=2, conditions={"humidity": [40.0]}))], [])
    assert outcome.rejected is not None
    assert outcome.rejected.reason == "unknown_condition"
    with plant.reading() as session:
        (entry,) = quarantine.newest(session, reason="unknown_condition", machine_id=None, limit=9)
    assert entry.detail == "machine 'pump-7' has no condition humidity; it has oil, load"


def test_an_identification_tells_its_mean_conditions(plant: Database, api: httpx.Client) -> None:
    with plant.transaction() as session:
        row = store_identification(session, identification(), run_id=1)
        row.conditions = {"oil": 55.5, "load": None}
        store_identification(session, identification(), run_id=2)
    assert api.get("/identifications/1").json()["conditions"] == {"oil": 55.5, "load": None}
    assert api.get("/identifications/2").json()["conditions"] is None


def test_a_document_with_wrong_conditions_is_answered_with_the_field(api: httpx.Client) -> None:
    document = machine(id="pump-9").model_dump(mode="json")
    for wrong, field in (
        ([{"name": "oil", "unit": "degC"}, {"name": "oil", "unit": "K"}], "conditions[0].name"),
        ([{"name": "oil temperature", "unit": "degC"}], "conditions[0].name"),
        ([{"name": f"c{i}", "unit": "K"} for i in range(17)], "conditions"),
        ([{"name": "oil", "unit": "degC", "usual_change": 0}], "conditions[0].usual_change"),
    ):
        answer = api.post("/machines", json=document | {"conditions": wrong})
        assert answer.status_code == 422
        assert any(error["field"].endswith(field) for error in answer.json()["errors"]), answer.json()["errors"]
    good = api.post("/machines", json=document | {"conditions": [CONDITIONS[0]], "operation": {"running_rpm": 4000}})
    assert [error["field"] for error in good.json()["errors"]] == ["operation.running_rpm"]
