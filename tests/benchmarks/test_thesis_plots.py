"""Figures and tables of the evidence page."""

import math
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest

from benchmarks.thesis import plots
from benchmarks.thesis.plots import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, PlottedCurve, chart
from benchmarks.thesis.tables import (
    decade,
    median_and_worst,
    paragraphs,
    percent,
    power,
    prose,
    shift,
    short_name,
    table,
    worst_of_seeds,
)

SPACE = "{http://www.w3.org/2000/svg}"


def drawn(*series: PlottedCurve, logarithmic: bool = False) -> ElementTree.Element:
    return ElementTree.fromstring(chart(title="a < b", x_label="x", y_label="y", series=series, logarithmic=logarithmic))


def curve(svg: ElementTree.Element) -> np.ndarray:
    """Corners (n, 2) of the only curve."""
    (path,) = [one for one in svg.iter(f"{SPACE}path") if one.get("fill") == "none"]
    return np.array([[float(number) for number in corner.split()] for corner in path.get("d", "")[1:].split("L")])


def test_a_straight_line_is_drawn_straight_from_corner_to_corner() -> None:
    corners = curve(drawn(PlottedCurve("line", [0, 5, 10], [0, 10, 20])))
    assert corners[0] == pytest.approx([LEFT, HEIGHT - BOTTOM])
    assert corners[1] == pytest.approx([(LEFT + WIDTH - RIGHT) / 2, (TOP + HEIGHT - BOTTOM) / 2])
    assert corners[2] == pytest.approx([WIDTH - RIGHT, TOP])


def test_decades_are_evenly_spaced_on_a_logarithmic_axis() -> None:
    corners = curve(drawn(PlottedCurve("decades", [0, 1, 2, 3], [1e-2, 1e-1, 1, 10]), logarithmic=True))
    assert np.diff(corners[:, 1]) == pytest.approx(np.full(3, -(HEIGHT - TOP - BOTTOM) / 3), abs=0.1)


def test_what_cannot_be_drawn_is_left_out() -> None:
    svg = drawn(PlottedCurve("some", [0, 1, 2, 3], [1.0, 0.0, math.nan, 10.0], points=True), logarithmic=True)
    assert len([one for one in svg.iter(f"{SPACE}circle") if one.get("r") == "3.5"]) == 2


def test_a_band_lies_around_its_curve_in_the_curve_s_colour() -> None:
    svg = drawn(PlottedCurve("found", [0, 1], [2.0, 4.0], band=([1.0, 3.0], [3.0, 5.0]), colour=1, dashed=True))
    (line,) = [one for one in svg.iter(f"{SPACE}path") if one.get("fill") == "none"]
    (band,) = [one for one in svg.iter(f"{SPACE}path") if one.get("fill") == line.get("stroke")]
    assert line.get("stroke") == plots.COLOURS[1]
    assert line.get("stroke-dasharray")
    corners = [[float(number) for number in one.split()] for one in band.get("d", "")[1:-1].split("L")]
    middle = curve(svg)
    assert np.mean([corners[0], corners[3]], axis=0) == pytest.approx(middle[0], abs=0.1)
    assert np.mean([corners[1], corners[2]], axis=0) == pytest.approx(middle[1], abs=0.1)


def test_title_axes_and_names_are_written() -> None:
    words = [one.text for one in drawn(PlottedCurve("F_x & F_y", [0, 1], [2, 3])).iter(f"{SPACE}text")]
    assert {"a < b", "x", "y", "F_x & F_y"} <= set(words)


def test_constant_values_still_have_an_axis() -> None:
    assert np.isfinite(curve(drawn(PlottedCurve("constant", [1, 2], [5, 5])))).all()
    assert np.isfinite(curve(drawn(PlottedCurve("constant", [1, 2], [10, 10]), logarithmic=True))).all()


def test_a_figure_is_saved_where_the_page_looks_for_it(monkeypatch: pytest.MonkeyPatch, tmp_path) -> None:  # type: ignore[no-untyped-def]
    monkeypatch.setattr(plots, "FOLDER", tmp_path / "evidence")
    assert plots.save("curve", "<svg/>") == "evidence/curve.svg"
    assert (tmp_path / "evidence" / "curve.svg").read_text() == "<svg/>"


def test_tables_and_numbers() -> None:
    assert table(["a", "b"], [["1", "2"]]) == "| a | b |\n| --- | --- |\n| 1 | 2 |"
    assert [percent(value) for value in (0.01234, 1.234, 123.4, 0.000001, math.nan)] == [
        "1.2 %",
        "120 %",
        "1.2e+04 %",
        "1e-04 %",
        "-",
    ]
    assert [shift(value) for value in (0.00806, -2.0, -1e-9)] == ["+0.81 %", "-200.00 %", "0 %"]
    assert [decade(value) for value in (3e-8, 2e-13)] == ["< 1e-05 %", "< 1e-10 %"]
    assert (power(1.234e18), power(math.inf)) == ("1.2e+18", "infinite")
    assert short_name("bearing.B1.kxx") == "B1 kxx"
    assert short_name("disc.D2.unbalance.real") == "D2 U real"
    assert paragraphs("a", "b") == "a\n\nb"
    assert (
        prose("""
        one
        two
        """)
        == "one\ntwo"
    )


def test_median_and_worst_errors_over_seeds() -> None:
    errors = np.array([[0.01, 0.02, 0.09], [0.01, 0.02, 0.05], [0.01, 0.02, 0.07]])
    assert median_and_worst(errors) == "2 % / 7 %"
    assert worst_of_seeds(errors) == "7 % (5 % to 9 %)"
