"""What a machine document may cost is looked at where it enters; what is stored stays readable."""

from pathlib import Path

import pytest
import yaml

from benchmarks.large_documents import train
from estimator.machine import parse_machine
from service.documents import UnreadableFile, read_machine
from storage import machines
from storage.database import Database
from tests.asking import Api

TOO_MANY = "604 elements of the shafts (600 sections); at most 500 are taken: join sections"


def test_a_document_that_asks_for_too_much_is_refused_by_field(plant: Database) -> None:
    api = Api(plant)
    answer = api.ask("POST", "/api/v1/machines", json=train(shafts=4, sections=600))
    assert answer.status_code == 422
    assert answer.json()["errors"] == [{"field": "shafts", "message": TOO_MANY}]
    assert api.ask("POST", "/api/v1/machines", json=train(sections=300)).status_code == 201
    larger = train(shafts=4, sections=600)
    assert api.ask("PUT", "/api/v1/machines/large", json=larger, headers={"if-match": "*"}).status_code == 422


def test_what_an_older_release_took_stays_readable(plant: Database) -> None:
    with plant.transaction() as session:
        machines.create(session, parse_machine(train(shafts=4, sections=600)))
    assert len(Api(plant).value("/machines/large")["document"]["shafts"]) == 4


def test_a_file_is_looked_at_too(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    path.write_text(yaml.safe_dump(train(shafts=4, sections=600)))
    with pytest.raises(UnreadableFile, match="604 elements of the shafts"):
        read_machine(path)
