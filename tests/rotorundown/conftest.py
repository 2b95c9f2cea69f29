"""A pump that was identified from simulated run-downs, once for all tests here."""

import matplotlib
import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from tests.paths import ROOT

matplotlib.use("Agg")


@pytest.fixture(scope="session")
def pump() -> Machine:
    return rd.read_machine(ROOT / "examples/motor-pump.yaml")


@pytest.fixture(scope="session")
def run(pump: Machine) -> rd.MachineRun:
    return rd.simulate(pump)


@pytest.fixture(scope="session")
def result(pump: Machine, run: rd.MachineRun) -> rd.Result:
    return rd.identify(pump, run)
