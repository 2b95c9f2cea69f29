"""Units that a request asks for: every path that takes them changes its values."""

import json
import math
from typing import Any

import pytest

from tests.api_in_process import PREFIX, Api, fields
from tests.paths import ROOT
from tests.plant import KEY


@pytest.mark.parametrize(
    ("units", "speed", "amplitude", "phase"),
    [
        ("mil_pp,hz,deg_lead", 1 / 60, 1 / 25.4, lambda lag: -lag % 360),
        ("m_p,rad_s,rad_lag", math.pi / 30, 5e-7, math.radians),
        ("um_p", 1.0, 0.5, lambda lag: lag),
    ],
)
def test_phasors_and_speeds_come_in_the_units_asked_for(
    modelled: Api, units: str, speed: float, amplitude: float, phase: Any
) -> None:
    usual = modelled.value("/identifications/1/bode", points=10)
    body = modelled.value("/identifications/1/bode", points=10, units=units)
    assert set(units.split(",")) <= set(body["units"].values())
    assert body["fitted"]["speed"] == pytest.approx([speed * one for one in usual["fitted"]["speed"]])
    for one, other in zip(body["measured"][0]["channels"], usual["measured"][0]["channels"], strict=True):
        for name in ("amplitude", "residual"):
            assert one[name] == pytest.approx([amplitude * value for value in other[name]])
        assert one["phase"] == pytest.approx([phase(value) for value in other["phase"]])
        assert one["residual_sigma"] == other["residual_sigma"]


ASKED = {"parameter": "coupling.C1.kxx", "rpm": 1000}
"""Of those that take it."""


def takes_units() -> dict[str, tuple[str, dict[str, Any]]]:
    """Every path whose answer is declared to come in units that are asked for, such units, and what else is asked."""
    found = {}
    for path, item in json.loads((ROOT / "docs" / "openapi.json").read_text())["paths"].items():
        takes = {one["name"]: one for one in item.get("get", {}).get("parameters", [])}
        # Centrelines and films are of machines on oil films only, and a report no JSON.
        if "units" in takes and not path.endswith(("/centreline", "/film-coefficients", "/report.pdf")):
            units = "n_um" if "n_um" in takes["units"]["description"] else "hz,mil_p,rad_lead"
            found[path.removeprefix(PREFIX)] = units, {name: value for name, value in ASKED.items() if name in takes}
    return found


@pytest.mark.parametrize(("path", "units", "asked"), [(path, *rest) for path, rest in takes_units().items()])
def test_units_that_are_taken_change_values(modelled: Api, path: str, units: str, asked: dict[str, Any]) -> None:
    place = path.format(identification_id=1, run_id=1, machine_id=KEY.machine)
    plain, other = numbers(modelled.value(place, **asked)), numbers(modelled.value(place, **asked, units=units))
    assert other != plain


def numbers(answer: Any) -> list[float]:
    """All numbers of an answer, in order."""
    if isinstance(answer, dict | list):
        parts = answer.values() if isinstance(answer, dict) else answer
        return [number for part in parts for number in numbers(part)]
    return [answer] if isinstance(answer, float) else []


@pytest.mark.parametrize("units", ["furlong", "um_pp,mil_pp", "", "rpm,,um_pp", "rpm " * 20])
def test_units_that_are_none_are_refused(modelled: Api, units: str) -> None:
    assert fields(modelled.get("/identifications/1/bode", units=units)) == ["query.units"]
