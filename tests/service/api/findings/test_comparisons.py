"""Correlation within an identification, and the comparison of two, through the API."""

import math

import numpy as np
import pytest

from estimator.machine.film_parameter_names import LOAD_BALANCE
from storage.database.engine import Database
from storage.machines import machines
from storage.tables.findings import EstimateRow
from tests.api_in_process import Api, problem
from tests.plant import identification, machine, store_identification
from tests.service.api.findings.modelled import outcome


def test_correlation_names_what_the_data_hardly_tell_apart(plant: Database) -> None:
    names = ("bearing.B1.kxx", "bearing.B1.kyy", "bearing.B1.cxx")
    covariance = np.array([[1.0, -0.95, 0.0], [-0.95, 1.0, 0.0], [0.0, 0.0, 0.0]])
    with plant.transaction() as session:
        one = identification(coordinates=names, covariance=covariance, point=np.zeros(3))
        store_identification(session, one, run_id=1)
    body = Api(plant).value("/identifications/1/correlation")
    assert body["coordinates"] == list(names)
    assert np.array(body["correlation"]) == pytest.approx(np.array([[1, -0.95, 0], [-0.95, 1, 0], [0, 0, 0]]))
    assert body["strongest"] == [{"one": names[0], "other": names[1], "correlation": pytest.approx(-0.95)}]


def test_two_identifications_are_compared(modelled: Api) -> None:
    body = modelled.value("/identifications/compare", first=1, second=2)
    changed = {one["parameter"]: one for one in body["changes"]}
    stiffness = changed["coupling.C1.kxx"]
    assert stiffness["per_cent"] == pytest.approx(10.0)
    assert stiffness["sigma"] == pytest.approx(math.log(1.1) / (0.01 * math.sqrt(2)), rel=1e-6)
    assert all(one["sigma"] == pytest.approx(0.0) for name, one in changed.items() if name != "coupling.C1.kxx")
    elements = {one["element"]: one for one in body["elements"]}
    assert elements["coupling.C1"]["probability"] < 1e-6
    assert elements["bearing.B1"]["distance"] == pytest.approx(0.0, abs=1e-9)
    assert (body["only_first"], body["only_second"]) == ([], [])


def test_what_one_of_two_does_not_determine_has_no_change(modelled: Api) -> None:
    name = "coupling.C1.kxx"
    with modelled.database.transaction() as session:
        row = session.get(EstimateRow, (2, name))
        assert row is not None
        row.value, row.reason = None, "the data do not determine it"
    changes = {one["parameter"]: one for one in modelled.value("/identifications/compare", first=1, second=2)["changes"]}
    assert changes.pop(name) == {"parameter": name, "first": pytest.approx(2e6), "second": None} | {
        "per_cent": None,
        "sigma": None,
    }
    assert all(one["second"] is not None for one in changes.values())


def test_identifications_of_two_machines_are_not_compared(plant: Database) -> None:
    api = Api(plant)
    with plant.transaction() as session:
        row = store_identification(session, outcome(), run_id=1)
        other = store_identification(session, outcome(), run_id=2)
        machines.create(session, machine(id="fan-2"))
        other.machine_id = "fan-2"
        first, second = row.id, other.id
    detail = problem(api.get("/identifications/compare", first=first, second=second), 422)["detail"]
    assert "one machine" in detail


def test_identifications_whose_loads_are_balanced_otherwise_are_not_compared(plant: Database) -> None:
    """Their couplings and pedestals follow from other loads: the difference would be taken for a change of the machine."""
    names = ("bearing.B1.clearance", "coupling.C1.kxx")
    with plant.transaction() as session:
        one = identification(coordinates=names, covariance=np.eye(2), point=np.zeros(2))
        older, newer = (store_identification(session, one, run_id=number) for number in (1, 2))
        assert newer.load_balance == LOAD_BALANCE
        older.load_balance = None
        first, second = newer.id, older.id
    api = Api(plant)
    detail = problem(api.get("/identifications/compare", first=first, second=second), 422)["detail"]
    assert f"identification {second} is by a release that balances the loads on oil films otherwise" in detail
    assert [one["load_balance"] for one in api.value("/machines/pump-7/identifications")] == [LOAD_BALANCE, None]
