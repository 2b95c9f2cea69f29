"""Tests what was identified, and what is to be."""

import math
from datetime import UTC, datetime, timedelta

import pytest

from tests.api_in_process import Api
from tests.plant import (
    SECOND,
    START,
)

MOMENT = datetime.fromtimestamp(START // SECOND, UTC)


def test_identifications_are_listed_newest_first(filled: Api) -> None:
    found = filled.value("/machines/pump-7/identifications")
    assert [one["accepted"] for one in found] == [True, False, True, True]
    assert [one["scope"] for one in found] == ["run", "run", "gathered", "run"]
    assert found[0]["options"] == {"starts": 10, "seed": 0}
    assert math.isfinite(found[0]["condition_number"])
    moment = (MOMENT + timedelta(hours=1)).isoformat()
    assert len(filled.value("/machines/pump-7/identifications", **{"from": moment, "to": moment})) == 1
    assert len(filled.value("/machines/pump-7/identifications", limit=2)) == 2


def test_an_identification_with_its_estimates(filled: Api) -> None:
    newest = filled.value("/machines/pump-7/identifications")[0]
    body = filled.value(f"/identifications/{newest['id']}")
    assert {name: body[name] for name in newest} == newest
    by_name = {one["parameter"]: one for one in body["estimates"]}
    assert by_name["coupling.C1.kxx"]["value"] == pytest.approx(2.4e6)
    assert by_name["coupling.C1.kxx"]["unit"] == "N/m"
    unknown = by_name["bearing.B1.kxy"]
    assert [unknown[name] for name in ("value", "standard_error", "lower", "upper")] == [None] * 4
    assert "uncertain" in unknown["reason"]
    unbalance = by_name["disc.D2.unbalance"]
    assert unbalance["imaginary"] == -5e-4
    assert unbalance["angle_deg"] == pytest.approx(360 - math.degrees(math.atan(0.5)))
    size = math.hypot(unbalance["value"], unbalance["imaginary"])
    assert unbalance["magnitude"] == pytest.approx(size)
    assert unbalance["lower"] < unbalance["magnitude"] < unbalance["upper"]
    assert unbalance["angle_half_width_deg"] == pytest.approx(math.degrees(math.asin(unbalance["upper"] / size - 1)))
    assert by_name["coupling.C1.kxx"]["angle_deg"] is None
    assert (body["coordinates"], body["covariance"]) == (None, None)


def test_the_covariance_comes_when_asked_for(filled: Api) -> None:
    newest = filled.value("/machines/pump-7/identifications")[0]
    body = filled.value(f"/identifications/{newest['id']}", covariance=True)
    size = len(body["coordinates"])
    assert size == len(body["estimates"]) + 2
    assert [len(row) for row in body["covariance"]] == [size] * size
    assert body["covariance"][0][0] == 1e-4


def test_jobs_are_listed_newest_first(filled: Api) -> None:
    found = filled.value("/machines/pump-7/jobs")
    assert (found[0]["state"], found[0]["error"]) == ("failed", "NotEnoughData: too few")
    assert (found[-1]["state"], found[-1]["finished_at"], found[-1]["attempts"]) == ("queued", None, 0)
    assert len(filled.value("/machines/pump-7/jobs", limit=1)) == 1
