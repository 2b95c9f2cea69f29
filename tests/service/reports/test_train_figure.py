"""The picture of the train on a report: what has an alert is red, whatever kind of element it is."""

import re

import pytest

from estimator.machine.document import parse_machine
from service.reports.plot_frame import MARKED
from service.reports.train_figure import train_figure
from tests.end_to_end.processes import example

PEDESTAL = {"id": "F1", "bearing": "B2"} | {"kxx": 1e9, "kyy": 1e9, "cxx": 1e5, "cyy": 1e5, "mxx": 500.0, "myy": 500.0}


def red(marked: str) -> tuple[int, list[str]]:
    """Return how much is red, and which names are."""
    machine = parse_machine(example("thesis-chapter-3") | {"pedestals": [PEDESTAL]})
    drawn = train_figure(machine, [marked])
    return drawn.count(MARKED), re.findall(rf'fill="{MARKED}"[^>]*>([^<]+)</text>', drawn)


@pytest.mark.parametrize(
    ("element", "name"),
    [("probe.B1X", "B1X"), ("pedestal.F1", "F1"), ("bearing.B2", "B2"), ("coupling.C1", "C1"), ("disc.D1", "D1")],
)
def test_what_has_an_alert_is_red_and_named(element: str, name: str) -> None:
    count, names = red(element)
    assert names == [name]
    assert count >= 2


def test_a_shaft_with_an_alert_is_red() -> None:
    machine = example("thesis-chapter-3")
    assert red(f"shaft.{machine['shafts'][0]['id']}")[0] >= 1
    assert red("shaft.none")[0] == 0
