"""Vector plots as SVG: directions and lengths are those of the vectors, names are text and no markup."""

import re
from xml.etree import ElementTree

import pytest

from service.balancing.vector_plot import RADIUS, PlottedVector, vector_plot


def arrows(drawn: str) -> list[tuple[float, float]]:
    """Ends of the vectors on the screen."""
    return [(float(x), float(y)) for x, y in re.findall(r'<line x1="0" y1="0" x2="([-\d.]+)" y2="([-\d.]+)"', drawn)]


def test_a_lag_grows_clockwise_from_the_right() -> None:
    (right, down) = arrows(vector_plot("B1X", [PlottedVector("a", 30 + 0j), PlottedVector("b", -30j)], unit="µm pp"))
    assert right[0] > 0
    assert right[1] == pytest.approx(0.0)
    assert down[0] == pytest.approx(0.0)
    assert down[1] == pytest.approx(right[0]), "90° of lag is below, where y grows on a screen"


def test_the_largest_vector_with_its_circle_fits_into_the_rings() -> None:
    drawn = vector_plot("B1X", [PlottedVector("small", 1 + 0j), PlottedVector("large", 17j, uncertain=4.0)], unit="µm pp")
    rings = [float(one) for one in re.findall(r'class="ring" r="([\d.]+)"', drawn)]
    assert max(rings) == pytest.approx(RADIUS)
    (small, large) = arrows(drawn)
    assert abs(large[1]) == pytest.approx(17 * small[0], rel=0.02)
    (radius,) = re.findall(r'r="([\d.]+)" fill="none"', drawn)
    assert abs(large[1]) + float(radius) <= RADIUS + 0.1


def test_names_are_text() -> None:
    drawn = vector_plot("B1X <at> 3 & 4", [PlottedVector("<b>run</b>", 1 + 1j)], unit="µm")
    assert "<b>" not in drawn
    assert "&lt;b&gt;run&lt;/b&gt; 1.41 ∠315° lag" in drawn
    ElementTree.fromstring(drawn)


def test_nothing_to_draw_is_an_empty_plot() -> None:
    assert "<svg" in vector_plot("B1X", [], unit="µm pp")
