"""Angles of weights stand beside their numbers on the disc's scale, wherever they are in an answer."""

import pytest

from estimator.machine.disc_scale import DiscScale
from service.balancing.rendering import on_scale


@pytest.mark.parametrize(("counted", "direction", "expected"), [("x-to-y", 1, 20.0), ("against-rotation", 1, 340.0)])
def test_angles_are_reported_on_the_scale_too(counted: str, direction: int, expected: float) -> None:
    scale = DiscScale.model_validate({"counted": counted, "zero_deg": 10.0})
    found = on_scale({"planes": [{"disc": "D1", "angle_deg": 30.0, "masses": [{"angle_deg": 10.0}]}]}, scale, direction)
    [plane] = found["planes"]
    assert plane["angle_deg"] == 30.0
    assert plane["scale_deg"] == pytest.approx(expected)
    assert plane["masses"][0]["scale_deg"] == pytest.approx(0.0)


@pytest.mark.parametrize(("said", "expected"), [(-90.0, 270.0), (450.0, 90.0), (360.0, 0.0), (-1e-15, 0.0)])
def test_angles_are_between_0_and_360(said: float, expected: float) -> None:
    found = on_scale({"disc": "D1", "angle_deg": said}, DiscScale(), 1)
    assert found["angle_deg"] == pytest.approx(expected)
    assert 0.0 <= found["scale_deg"] < 360.0
