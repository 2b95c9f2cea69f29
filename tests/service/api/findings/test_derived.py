"""Derived quantities in the answers of the API: of an identification, and over time."""

from collections.abc import Iterator

import httpx
import pytest

from benchmarks.serving import served
from estimator.updated_model.derived_quantities import Derived
from storage.database.engine import Database
from storage.findings import derived
from tests.plant import SECOND, START, identification, store_identification

HOUR = 3600 * SECOND
FORCE = "coupling.C1.misalignment_force"


@pytest.fixture
def api(plant: Database) -> Iterator[httpx.Client]:
    """Two identifications of a machine, the second without a force."""
    quantities = (
        [Derived(FORCE, "N", 120.0, 110.0, 130.0), Derived("critical_speed.1", "rad/s", 150.0, 149.0, 151.0)],
        [Derived(FORCE, "N", None, None, None, reason="nobody knows")],
    )
    with plant.transaction() as session:
        for number, some in enumerate(quantities, start=1):
            row = store_identification(session, identification(), run_id=number, measured_at=START + number * HOUR)
            derived.add(session, row, some)
    with served(plant) as url, httpx.Client(base_url=url, timeout=20.0) as client:
        yield client


def test_an_identification_tells_what_was_derived_in_the_order_of_storing(api: httpx.Client) -> None:
    found = api.get("/identifications/1").json()["derived"]
    assert found == [
        {"name": FORCE, "unit": "N", "value": 120.0, "lower": 110.0, "upper": 130.0, "reason": None},
        {"name": "critical_speed.1", "unit": "rad/s", "value": 150.0, "lower": 149.0, "upper": 151.0, "reason": None},
    ]
    (other,) = api.get("/identifications/2").json()["derived"]
    assert (other["value"], other["reason"]) == (None, "nobody knows")


def test_trends_of_derived_quantities_stand_beside_those_of_parameters(api: httpx.Client) -> None:
    asked = {"parameter": [FORCE, "coupling.C1.kxx", "critical_speed.1"]}
    force, stiffness, speed = api.get("/machines/pump-7/trends", params=asked).json()["series"]
    assert (force["parameter"], force["unit"], force["identification"]) == (FORCE, "N", [1, 2])
    assert (force["value"], force["lower"], force["upper"]) == ([120.0, None], [110.0, None], [130.0, None])
    assert force["standard_error"] == [None, None]
    assert force["quality"] == ["accepted", "not_estimable"]
    assert stiffness["value"] == [2e6, 2e6]
    assert None not in stiffness["standard_error"]
    assert (speed["unit"], speed["value"], speed["quality"]) == ("rad/s", [150.0], ["accepted"])


def test_trends_of_derived_quantities_over_a_time_range(api: httpx.Client) -> None:
    for limit in ({"from": "2023-11-14T23:30:00Z"}, {"to": "2023-11-14T22:30:00Z"}):
        (found,) = api.get("/machines/pump-7/trends", params={"parameter": "critical_speed.1"} | limit).json()["series"]
        assert found["value"] == []
    (found,) = api.get("/machines/pump-7/trends", params={"parameter": FORCE, "scope": "gathered"}).json()["series"]
    assert found["value"] == []
