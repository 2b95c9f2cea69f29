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
            "the bore of a four_lobe bearing without preload is round: usual is 0.3 to 0.6",
        ),
        (
            lambda said: said["bearings"][3]["film"].update(valid_above_rpm=5000.0),
            "bearings[3].film.valid_above_rpm",
            "5000 r/min is not below the end of the speed range, 4692 r/min: no sample would be left",
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
def test_the_discs_of_no_example_are_named(document: Path) -> None:
    assert not [one for one in document_warnings(read_machine(document)) if one.field.startswith("discs")]


def test_a_static_force_far_beyond_the_weight_is_named() -> None:
    said = motor_compressor_document("flexible")
    load = {"id": "gear", "shaft": said["shafts"][0]["id"], "station": 0.7, "force_y": -5e6, "force_x": 2e4}
    said["static_loads"] = [load]
    (warning,) = document_warnings(parse_machine(said))
    assert warning.field == "static_loads[0].force_y"
    assert warning.words.startswith("-5e+06 N is ")
    assert "times the weight of all rotors, " in warning.words
