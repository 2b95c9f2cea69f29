"""Warnings of documents that are taken: what is probably a mistake is named with its place and what is usual."""

from pathlib import Path
from typing import Any

import pytest

from estimator.machine.checks.document_warnings import document_warnings
from estimator.machine.document import parse_machine
from formats.files.document_files import read_machine
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.trains import chapter_3_document
from tests.paths import EXAMPLES

PEDESTAL = {"id": "P1", "bearing": "B1", "kxx": 4e8, "kyy": 6e8, "cxx": 4e4, "cyy": 6e4, "mxx": 600.0, "myy": 600.0}
GEAR = {"id": "gear", "shaft": "S1", "station": 0.7}


def supplied(said: dict[str, Any], *oils: dict[str, Any]) -> None:
    """Give the first bearings these oils of one supply, where they name no other."""
    for bearing, oil in zip(said["bearings"], oils, strict=False):
        bearing["film"]["oil"] = {"supply": "main"} | oil


@pytest.mark.parametrize("axis", ["x", "y"])
def test_an_elevation_beyond_the_clearance_is_named(axis: str) -> None:
    said = motor_compressor_document("flexible")
    clearance = said["bearings"][2]["film"]["radial_clearance"]
    said["bearings"][2]["film"][f"elevation_{axis}"] = -1.5 * clearance
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == f"bearings[2].film.elevation_{axis}"
    assert warning.words.startswith(f"{-1.5e6 * clearance:.4g} µm is more than the radial clearance, {1e6 * clearance:.4g} µm")
    said["bearings"][2]["film"][f"elevation_{axis}"] = 0.9 * clearance
    assert document_warnings(parse_machine(said)) == ()


def test_an_offset_that_is_aimed_at_warm_beyond_the_clearance_is_named() -> None:
    said = motor_compressor_document("flexible")
    target = {"coupling": "C1", "left_cold": {"offset_vertical": -2e-3, "angle_vertical": 3e-4}}
    said["operation"] = {"alignment_targets": [target]}
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == "operation.alignment_targets[0].left_cold.offset_vertical"
    assert warning.words.startswith("-2000 µm is more than the radial clearance")
    target["growth"] = {"offset_vertical": 1e-3}
    (warning,) = document_warnings(parse_machine(said))
    assert warning.words.startswith("-2000 µm, -1000 µm with its growth, is more than the radial clearance")
    target["growth"] = {"offset_vertical": 1.98e-3}
    assert document_warnings(parse_machine(said)) == ()


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        (
            lambda said: said["speed_range"].update(minimum_rpm=5, maximum_rpm=60),
            "speed_range.maximum_rpm",
            "60 r/min: few machines are that slow; was 60 Hz meant, 3600 r/min?",
        ),
        (
            lambda said: said.update(operation={"running_rpm": 50}),
            "operation.running_rpm",
            "50 r/min lies below the speed range, 686 to 4692 r/min; was 50 Hz meant, 3000 r/min?",
        ),
        (
            lambda said: said.update(operation={"running_rpm": 650}),
            "operation.running_rpm",
            "650 r/min lies below the speed range, 686 to 4692 r/min",
        ),
        (
            lambda said: said["bearings"][1]["film"].update(radial_clearance=3.9e-4),
            "bearings[1].film.radial_clearance",
            "390 µm is 0.0097 of the radius, 0.04 m: usual is 0.001 to 0.002 of it",
        ),
        (
            lambda said: said["bearings"][1]["film"].update(length=0.4),
            "bearings[1].film.length",
            "0.4 m is 5 times the diameter, 0.08 m: usual is 0.3 to 1.2 times",
        ),
        (
            lambda said: said["bearings"][0]["film"].update(diameter=0.12, length=0.06),
            "bearings[0].film.diameter",
            "0.12 m, but shaft 'S1' is 0.08 m thick at station 0.1 m",
        ),
        (
            lambda said: said["bearings"][2]["film"]["oil"].update(viscosity=0.4),
            "bearings[2].film.oil.viscosity",
            "0.4 Pa s: warm turbine oil has 0.005 to 0.1 Pa s",
        ),
        (
            lambda said: said["bearings"][1]["film"].update(radial_clearance=1.8e-4),
            "bearings[1].film.radial_clearance",
            "180 µm is 0.0045 of the radius, 0.04 m: usual is 0.001 to 0.002 of it, half the difference of the diameters",
        ),
        (
            lambda said: said["bearings"][2]["film"].update(oil={"iso_vg": 32, "temperature_c": 140.0}),
            "bearings[2].film.oil.temperature_c",
            "140 °C: oil is hardly ever above 120 °C there; was 140 °F meant, 60 °C?",
        ),
        (
            lambda said: said["bearings"][2]["film"].update(oil={"iso_vg": 32, "inlet_c": 113.0}),
            "bearings[2].film.oil.inlet_c",
            "113 °C: oil is hardly ever above 80 °C there; was 113 °F meant, 45 °C?",
        ),
        (
            lambda said: said["bearings"][3]["film"].update(profile="four_lobe"),
            "bearings[3].film.preload",
            "profile four_lobe without preload is a round bore: usual is 0.3 to 0.6",
        ),
        (
            lambda said: said["bearings"][3]["film"].update(valid_above_rpm=5000.0),
            "bearings[3].film.valid_above_rpm",
            "5000 r/min is not below the end of the speed range, 4692 r/min: no sample would be left",
        ),
        (
            lambda said: said["bearings"][3]["film"].update(valid_above_rpm=4500.0),
            "bearings[3].film.valid_above_rpm",
            "4500 r/min is near the end of the speed range, 4692 r/min: few samples would be left",
        ),
        (
            lambda said: said["bearings"][3]["film"]["oil"].update(viscosity=9e-6),
            "bearings[3].film.oil.viscosity",
            "9e-06 Pa s: warm turbine oil has 0.005 to 0.1 Pa s, 5 to 100 mPa s (cP); was 9e-06 m²/s meant, 0.00783 Pa s?",
        ),
        (
            lambda said: said["bearings"][3]["film"].update(profile="elliptical", preload=0.5, groove_deg=0.35),
            "bearings[3].film.groove_deg",
            "0.35 ° wide grooves: usual is 5 to 45 °; was 0.35 rad meant, 20.1 °?",
        ),
        (
            lambda said: said["probes"][1].update(angle_deg=0.785),
            "probes[1].angle_deg",
            "0.785 °: probes mostly stand at multiples of 15°; was 0.785 rad meant, 45 °?",
        ),
        (
            lambda said: said["discs"][0].update(polar_inertia=1.9e6),
            "discs[0].polar_inertia",
            "1.9e+06 kg m² of ",
        ),
        (
            lambda said: said["discs"][0].update(unbalance={"magnitude": 1500, "angle_deg": 0}),
            "discs[0].unbalance.magnitude",
            "1500 kg m shifts the centre of mass of shaft 'S1' with its discs, ",
        ),
        (
            lambda said: said.update(pedestals=[PEDESTAL | {"mxx": 0.6}]),
            "pedestals[0].mxx",
            "0.6 kg is ",
        ),
        (
            lambda said: said.update(pedestals=[PEDESTAL | {"myy": 6e5}]),
            "pedestals[0].myy",
            "600000 kg is ",
        ),
        (
            lambda said: said.update(static_loads=[GEAR | {"force_y": -5.0}]),
            "static_loads[0].force_y",
            "-5 N is 0.00",
        ),
        (
            lambda said: said.update(static_loads=[GEAR]),
            "static_loads[0]",
            "neither a force nor a spread: it does nothing",
        ),
        (
            lambda said: said.update(static_loads=[GEAR | {"force_y": -500.0, "force_y_spread": 5e4}]),
            "static_loads[0].force_y_spread",
            "50000 N is ",
        ),
        (
            lambda said: supplied(said, {"iso_vg": 32, "temperature_c": 60}, {"iso_vg": 46, "temperature_c": 60}),
            "bearings[1].film.oil.iso_vg",
            "ISO VG 46, but bearing B1 of the same supply 'main' has ISO VG 32: one supply has one oil",
        ),
        (
            lambda said: supplied(said, {"viscosity": 0.009}, {"viscosity": 0.03}),
            "bearings[1].film.oil.viscosity",
            "0.03 Pa s, but bearing B1 of the same supply 'main' has 0.009 Pa s: one supply has one oil, usual is up to twice",
        ),
        (
            lambda said: supplied(said, *[{"viscosity": 0.009, "supply": name} for name in ("main", "mian", "main")]),
            "bearings[1].film.oil.supply",
            "'mian' is the supply of this bearing alone, 'main' that of B1, B3: is it the same one, was 'main' meant?",
        ),
        (
            lambda said: said["materials"]["steel"].update(density=7.85),
            "materials.steel.density",
            "7.85 kg/m³: steel has 7850 kg/m³; was 7.85 g/cm³ meant?",
        ),
        (
            lambda said: said["couplings"][0].update(kyy=1.2),
            "couplings[0].kyy",
            "1.2 N/m: usual is 1e+5 to 1e+10 N/m; was 1.2 N/µm meant?",
        ),
        (
            lambda said: said["couplings"][0].update(k_phix=0.02),
            "couplings[0].k_phix",
            "0.02 N m/rad: usual is 1e+3 to 1e+8 N m/rad; was 0.02 MN m/rad meant?",
        ),
    ],
)
def test_what_is_possible_but_odd_is_named_with_what_is_usual(change: Any, field: str, words: str) -> None:
    said = motor_compressor_document("flexible")
    change(said)
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == field
    assert warning.words.startswith(words)


def test_what_preload_leaves_of_a_clearance_is_judged() -> None:
    said = motor_compressor_document("flexible")
    said["bearings"][1]["film"].update(profile="elliptical", preload=0.5, radial_clearance=1.8e-4)
    assert document_warnings(parse_machine(said)) == ()


def test_a_disc_in_grams_is_named_with_what_its_shaft_carries() -> None:
    said = chapter_3_document()
    assert document_warnings(parse_machine(said)) == ()
    said["discs"][1]["mass"] = 1500.0
    (warning,) = document_warnings(parse_machine(said))
    assert str(warning) == (
        "discs[1].mass: 1500 kg is 490 times the mass of shaft 'S1', 3.06 kg: usual is 0.1 to 5 times; "
        "was 1500 g meant, 1.5 kg?"
    )


@pytest.mark.parametrize("document", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_nothing_of_an_example_is_named(document: Path) -> None:
    assert document_warnings(read_machine(document)) == ()


@pytest.mark.parametrize(
    ("change", "question"),
    [
        (lambda said: said["discs"][0].update(polar_inertia=1.9e6), "was 1.9e+06 kg mm² meant, 1.9 kg m²?"),
        (
            lambda said: said["discs"][0].update(unbalance={"magnitude": 1500, "angle_deg": 0}),
            "was 1500 g mm meant, 0.0015 kg m?",
        ),
        (lambda said: said.update(pedestals=[PEDESTAL | {"mxx": 0.6}]), "was 0.6 t meant, 600 kg?"),
        (lambda said: said.update(pedestals=[PEDESTAL | {"mxx": 6e5}]), "was 600000 g meant, 600 kg?"),
        (lambda said: said.update(static_loads=[GEAR | {"force_y": -5.0}]), "was -5 kN meant, -5000 N?"),
    ],
)
def test_the_unit_that_was_probably_meant_is_asked_for(change: Any, question: str) -> None:
    said = motor_compressor_document("flexible")
    change(said)
    (warning,) = document_warnings(parse_machine(said))
    assert warning.words.endswith(f"; {question}")


@pytest.mark.parametrize(
    "change",
    [
        lambda said: said.update(pedestals=[PEDESTAL]),
        lambda said: said.update(static_loads=[GEAR | {"force_y_spread": 500.0}]),
        lambda said: said.update(static_loads=[GEAR | {"force_x": 5.0, "force_y": -500.0}]),
        lambda said: said["probes"][0].update(angle_deg=1.5),
        lambda said: said["discs"][0].update(polar_inertia=0.0),
        lambda said: supplied(said, {"viscosity": 0.009}, {"viscosity": 0.012}),
        lambda said: supplied(said, {"iso_vg": 46, "temperature_c": 50}, {"iso_vg": 46, "temperature_c": 70}),
        lambda said: supplied(said, *[{"viscosity": 0.009, "supply": f"oil_{one}"} for one in (1, 2, 3, 1)]),
        lambda said: supplied(said, *[{"viscosity": 0.009, "supply": name} for name in ("main", "gear", "main")]),
    ],
)
def test_what_may_well_be_right_is_not_named(change: Any) -> None:
    said = motor_compressor_document("flexible")
    change(said)
    assert document_warnings(parse_machine(said)) == ()


def test_a_static_force_far_beyond_the_weight_is_named() -> None:
    said = motor_compressor_document("flexible")
    load = {"id": "gear", "shaft": said["shafts"][0]["id"], "station": 0.7, "force_y": -5e6, "force_x": 2e4}
    said["static_loads"] = [load]
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == "static_loads[0].force_y"
    assert warning.words.startswith("-5e+06 N is ")
    assert "times the weight of all rotors, " in warning.words


def test_a_train_in_two_pieces_is_named() -> None:
    said = chapter_3_document()
    said["couplings"] = []
    (warning,) = document_warnings(parse_machine(said))
    assert (warning.field, warning.words) == ("shafts[1]", "no coupling joins shaft 'S2' to shaft 'S1': is one missing?")


def test_a_probe_that_is_described_twice_is_named() -> None:
    said = chapter_3_document()
    said["probes"].append(said["probes"][0] | {"id": "again", "angle_deg": said["probes"][0]["angle_deg"] + 360.0})
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == f"probes[{len(said['probes']) - 1}].angle_deg"
    assert f"is where probe '{said['probes'][0]['id']}' stands" in warning.words
    said["probes"][-1]["absolute"] = True
    assert document_warnings(parse_machine(said)) == ()
