"""The figures of the house keep their bounds, and one that does not is seen."""

from tests.house_figures import HouseFigure, figures


def test_every_figure_keeps_its_bound() -> None:
    assert [str(one) for one in figures() if not one.holds] == []


def test_a_figure_that_does_not_hold_is_seen() -> None:
    assert not HouseFigure("lines", 60, 61).holds
    assert not HouseFigure("part", 95, 94.9, " %", least=True).holds
    assert str(HouseFigure("lines", 60, 61)).endswith("FAILS")
