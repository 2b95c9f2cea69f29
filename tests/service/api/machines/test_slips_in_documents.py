"""Slips in documents of trains on oil films: one named error at the API and in the library, with unit and what is usual."""

from collections.abc import Callable
from typing import Any

import pytest

from rotorundown import read_machine
from rotorundown.machine_files import WrongMachine
from tests.api_in_process import PREFIX, Api, problem
from tests.estimator.statics.films import motor_compressor_document

Document = dict[str, Any]
SPEEDS, STIFF = [700, 1500, 2500, 3500, 4600], [1e7, 1.2e7, 1.3e7, 1.4e7, 1.5e7]


def film(**changes: Any) -> Callable[[Document], None]:
    return lambda said: said["bearings"][1]["film"].update(changes)


def table(**changes: Any) -> Callable[[Document], None]:
    def put(said: Document) -> None:
        columns = {"form": "table", "speed_rpm": SPEEDS, "kxx": STIFF} | changes
        del said["bearings"][1]["kxx"]
        said["bearings"][1]["speed_dependence"] = columns

    return put


SLIPS: dict[str, tuple[Callable[[Document], Any], str, str]] = {
    "a misspelt field": (
        lambda said: said["probes"][0].update(angel_deg=45.0),
        "probes[0].angel_deg",
        "there is no such field; did you mean 'angle_deg'?",
    ),
    "a clearance of more than a tenth of the radius": (
        film(radial_clearance=0.0045),
        "bearings[1].film",
        "0.0045 m is more than a tenth of the radius 0.04 m; usual is 0.001 to 0.002 of it",
    ),
    "a negative film": (film(radial_clearance=-9e-5), "bearings[1].film.radial_clearance", "greater than 0"),
    "four speeds": (
        table(speed_rpm=SPEEDS[:4], kxx=STIFF[:4]),
        "bearings[1].speed_dependence.speed_rpm",
        "at least 5 speeds [r/min], usually 10 to 30, not 4",
    ),
    "speeds out of order": (
        table(speed_rpm=[700, 2500, 1500, 3500, 4600]),
        "bearings[1].speed_dependence.speed_rpm",
        "speeds [r/min] must ascend: 1500 at place 3 follows 2500",
    ),
    "a hole in a column": (table(kxx=[*STIFF[:2], None, *STIFF[3:]]), "bearings[1].speed_dependence.kxx[2]", "number"),
    "a decimal comma": (table(kxx=[*STIFF[:4], "1,5e7"]), "bearings[1].speed_dependence.kxx[4]", "number"),
    "a grade without temperature": (
        film(oil={"iso_vg": 46}),
        "bearings[1].film.oil",
        "iso_vg needs either temperature_c, of the film, usually 40 to 80 °C, or inlet_c",
    ),
    "viscosity in mPa s": (
        film(oil={"viscosity": 9.0}),
        "bearings[1].film.oil.viscosity",
        "was 9 mPa s (cP) meant, 0.009 Pa s?",
    ),
    "E in GPa": (
        lambda said: said["materials"]["steel"].update(young_modulus=210.0),
        "materials.steel.young_modulus",
        "210 N/m²: steel has 2.1e+11 N/m²; was 210 GPa meant, 2.1e+11 N/m²?",
    ),
    "kxx in N/µm": (
        lambda said: said["bearings"][0].update(kxx=90.0),
        "bearings[0].kxx",
        "90 N/m: usual is 1e+5 to 1e+10 N/m; was 90 N/µm meant, 9e+07 N/m?",
    ),
    "a shaft of 20 m": (
        lambda said: said["shafts"][0]["sections"][0].update(outer_diameter=20.0),
        "shafts[0].sections[0].outer_diameter",
        "20 m: usual is 0.01 to 2 m; was 20 mm meant, 0.02 m?",
    ),
}


def slipped(name: str) -> Document:
    said = motor_compressor_document("flexible")
    said |= {"id": "pump-7", "plant": "plant-1"}
    SLIPS[name][0](said)
    return said


@pytest.mark.parametrize("name", SLIPS)
def test_a_slip_is_refused_at_the_api_by_name(api: Api, name: str) -> None:
    _, field, words = SLIPS[name]
    errors = problem(api.ask("PUT", f"{PREFIX}/machines/pump-7", json=slipped(name)), 422)["errors"]
    assert [one["field"] for one in errors] == [field]
    assert words in errors[0]["message"]


@pytest.mark.parametrize("name", SLIPS)
def test_the_library_refuses_it_in_the_same_words(name: str) -> None:
    _, field, words = SLIPS[name]
    with pytest.raises(WrongMachine) as raised:
        read_machine(slipped(name))
    assert f"{field}: " in str(raised.value)
    assert words in str(raised.value)
