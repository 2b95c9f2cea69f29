"""Values that only a slip of the unit explains: refused at the door by name, and read from the store all the same."""

from typing import Any

import pytest

from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError, parse_machine
from formats.files.document_files import read_yaml
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.trains import chapter_3_document
from tests.paths import EXAMPLES


def gigapascals(document: dict[str, Any]) -> None:
    document["materials"]["steel"]["young_modulus"] = 210.0


def megapascals(document: dict[str, Any]) -> None:
    document["materials"]["steel"]["young_modulus"] = 206_000.0


def millimetres(document: dict[str, Any]) -> None:
    document["shafts"][0]["sections"][0]["outer_diameter"] = 20.0


def grams_per_cubic_centimetre(document: dict[str, Any]) -> None:
    document["materials"]["steel"]["density"] = 7.85


def soft_coupling(document: dict[str, Any]) -> None:
    document["couplings"][0]["kxx"] = 1.2


def per_cent(document: dict[str, Any]) -> None:
    document["parameters"] = [{"names": "bearing.B1.k*", "spread": 30}]


def more_polar_than_a_disc(document: dict[str, Any]) -> None:
    document["discs"][0] |= {"diametral_inertia": 4.0, "polar_inertia": 100.0}


def newtons_per_micrometre(document: dict[str, Any]) -> None:
    document["bearings"][1]["kxx"] = 90.0


@pytest.mark.parametrize(
    ("slip", "field", "words"),
    [
        (gigapascals, "materials.steel.young_modulus", "210 N/m²: steel has 2.1e\\+11 N/m²; was 210 GPa meant"),
        (megapascals, "materials.steel.young_modulus", "206000 N/m²: steel has 2.1e\\+11 N/m²; was 206000 MPa meant"),
        (millimetres, "shafts\\[0\\].sections\\[0\\].outer_diameter", "20 m: usual is 0.01 to 2 m; was 20 mm meant"),
        (grams_per_cubic_centimetre, "materials.steel.density", "7.85 kg/m³: steel has 7850 kg/m³; was 7.85 g/cm³ meant"),
        (soft_coupling, "couplings\\[0\\].kxx", "1.2 N/m: usual is 1e\\+5 to 1e\\+10 N/m; was 1.2 N/µm meant, 1.2e\\+06 N/m"),
        (per_cent, "parameters\\[0\\].spread", "30: usual is 0.01 to 1; was 30 % meant, 0.3"),
        (
            more_polar_than_a_disc,
            "discs\\[0\\].polar_inertia",
            "100 kg m² is more than twice diametral_inertia, 4 kg m²: no body",
        ),
        (newtons_per_micrometre, "bearings\\[1\\].kxx", "90 N/m: usual is 1e\\+5 to 1e\\+10 N/m; was 90 N/µm meant"),
    ],
)
def test_a_slip_of_the_unit_is_refused_where_the_document_enters(slip: Any, field: str, words: str) -> None:
    document = chapter_3_document()
    slip(document)
    with pytest.raises(DocumentError, match=f"{field}: {words}"):
        accepted_machine(document)
    assert parse_machine(document).id == "thesis-chapter-3"


def test_the_thesis_train_is_plausible() -> None:
    assert accepted_machine(chapter_3_document()).bearings


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"diameter": 80.0}, "diameter", "80 m: usual is 0.02 to 1 m; was 80 mm meant"),
        ({"length": 40.0}, "length", "40 m: usual is 0.02 to 1 m; was 40 mm meant"),
        ({"length": 0.002}, "length", "0.002 m is 0.025 times the diameter, 0.08 m: usual is 0.3 to 1.2 times"),
        ({"elevation_y": 0.1}, "elevation_y", "0.1 m over the aligned place: usual is up to 0.0005 m; was 0.1 mm meant"),
        ({"elevation_x": -50.0}, "elevation_x", "-50 m over the aligned place: usual is up to 0.0005 m; was -50 µm meant"),
        ({"oil": {"viscosity": 9.0}}, "oil.viscosity", "9 Pa s: usual is 0.005 to 0.1 Pa s; was 9 mPa s"),
        ({"oil": {"viscosity": 32.0}}, "oil.viscosity", "32 Pa s: usual is 0.005 to 0.1 Pa s; was 32 mPa s"),
        ({"groove_deg": 30.0}, "groove_deg", "30 °: grooves go with profile two_axial_grooves or a lobed one, not with plain"),
    ],
)
def test_a_slip_of_the_unit_in_a_film_is_refused(change: dict[str, Any], field: str, words: str) -> None:
    document = motor_compressor_document("flexible")
    document["bearings"][2]["film"] |= {"diameter": 0.08, "length": 0.04} | change
    with pytest.raises(DocumentError, match=f"bearings\\[2\\].film.{field}: {words}"):
        accepted_machine(document)


def test_an_elevation_in_micrometres_of_a_bearing_beside_films_is_refused() -> None:
    document = motor_compressor_document("flexible")
    del document["bearings"][0]["film"]
    for bearing in document["bearings"][1:]:
        bearing["speed_dependence"] = {"form": "journal"}
    document["bearings"][0]["elevation"] = {"y": 20.0}
    words = r"bearings\[0\].elevation.y: 20 m over the aligned place: usual is up to 0.0005 m; was 20 µm meant"
    with pytest.raises(DocumentError, match=words):
        accepted_machine(document)


def test_a_pedestal_in_newtons_per_micrometre_is_refused() -> None:
    document = motor_compressor_document("flexible")
    terms = {"kxx": 250.0, "kyy": 6e8, "cxx": 4e4, "cyy": 6e4, "mxx": 600.0, "myy": 600.0}
    document["pedestals"] = [{"id": "P1", "bearing": "B1", **terms}]
    with pytest.raises(DocumentError, match=r"pedestals\[0\].kxx: 250 N/m: usual is 1e\+6 to 1e\+10 N/m; was 250 N/µm meant"):
        accepted_machine(document)


def test_a_spread_of_many_times_an_unbalance_or_a_cross_term_is_taken() -> None:
    document = chapter_3_document()
    document["parameters"] = [{"names": "disc.D1.unbalance", "spread": 30}]
    assert accepted_machine(document).parameters


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (
            {"kxx": [90.0] * 5},
            "bearings[0].speed_dependence.kxx",
            "90 N/m: usual is 1e+5 to 1e+9 N/m; was 90 N/µm meant, 9e+07",
        ),
        ({"speed_rpm": [10, 20, 30, 50, 75]}, "bearings[0].speed_dependence.speed_rpm", "was 75 Hz meant, 4500 r/min?"),
    ],
)
def test_a_rule_for_what_follows_a_table_does_not_hide_the_unit_of_the_table(
    change: dict[str, Any], field: str, words: str
) -> None:
    document = read_yaml(EXAMPLES / "motor-on-rolling-elements.yaml")
    table = {"form": "table", "speed_rpm": [500, 1000, 2000, 3000, 5000], "kxx": [9e7] * 5} | change
    document["bearings"][0]["speed_dependence"] = table
    del document["bearings"][0]["kxx"]
    with pytest.raises(DocumentError) as raised:
        accepted_machine(document)
    told = dict(raised.value.problems)
    assert "follow a table" in told["parameters[0]"]
    assert words in told[field]
