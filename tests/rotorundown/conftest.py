"""A pump that was identified from simulated run-downs, once for all tests here."""

from collections.abc import Iterator

import matplotlib
import pytest
from matplotlib import pyplot

import rotorundown as rd
from estimator.machine.document import Machine
from tests.paths import ROOT

matplotlib.use("Agg")


@pytest.fixture(autouse=True)
def _figures_closed() -> Iterator[None]:
    """Close what a test has drawn: pyplot warns of more than twenty open figures, and which tests share a process differs."""
    yield
    pyplot.close("all")


@pytest.fixture(scope="session")
def pump() -> Machine:
    return rd.read_machine(ROOT / "examples/motor-pump.yaml")


@pytest.fixture(scope="session")
def run(pump: Machine) -> rd.MachineRun:
    return rd.simulate(pump)


@pytest.fixture(scope="session")
def result(pump: Machine, run: rd.MachineRun) -> rd.Result:
    return rd.identify(pump, run)
