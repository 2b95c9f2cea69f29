"""The orbits of the printed report: no word lies on another or goes over the figure's edge."""

import itertools
import xml.etree.ElementTree as ElementTree
from typing import NamedTuple

import numpy as np
import pytest

from estimator.phasors.probe_axes import ProbeStation
from service.reports.orbit_figure import SIZE, orbit_figure

WIDE, HIGH = 0.62, 0.75
"""Mean width and height of letters, in their size, of the report's typeface [-]."""


class Box(NamedTuple):
    """Area that a word covers."""

    left: float
    top: float
    right: float
    bottom: float


@pytest.mark.parametrize("angles", [(0.0, 90.0), (-45.0, 45.0), (45.0, 135.0), (0.0, 60.0), (180.0, 270.0), (10.0, 100.0)])
@pytest.mark.parametrize("names", [("B1X", "B1Y"), ("journal 1 left", "journal 1 right")])
def test_no_word_lies_on_another(angles: tuple[float, float], names: tuple[str, str]) -> None:
    place = ProbeStation("S1", 0.1, names, (0, 1), np.deg2rad(angles))
    drawn = ElementTree.fromstring(orbit_figure(place, np.array([30.0, 20.0j]), None))
    words = {str(one.text): box(one) for one in drawn.iter() if one.tag.endswith("text")}
    assert {*names, "x", "y"} <= words.keys()
    for (name, one), (other_name, other) in itertools.combinations(words.items(), 2):
        apart = one.right <= other.left or other.right <= one.left or one.bottom <= other.top or other.bottom <= one.top
        assert apart, f"{name} lies on {other_name}"
    for name, one in words.items():
        assert max(abs(one.left), abs(one.right)) <= SIZE / 2.0, f"{name} goes over the edge"


def box(text: "ElementTree.Element[str]") -> Box:
    size = float(text.attrib["font-size"])
    wide, at, bottom = WIDE * size * len(str(text.text)), float(text.attrib["x"]), float(text.attrib["y"])
    left = {"start": at, "middle": at - wide / 2.0, "end": at - wide}[text.attrib["text-anchor"]]
    return Box(left, bottom - HIGH * size, left + wide, bottom)
