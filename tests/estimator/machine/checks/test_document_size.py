"""Tests how large a machine document may be where it enters, and that one that is stored already is read all the same."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from benchmarks.estimator.large_trains import large_train
from estimator.fit.fit_samples import LARGEST_SAMPLE_COUNT, most_samples
from estimator.machine.checks.document_size import (
    FEWEST_SAMPLES,
    LARGEST_ELEMENTS,
    LARGEST_PADS,
    LARGEST_SECTIONS,
    DocumentSize,
    accepted_machine,
    document_size,
    require_acceptable,
)
from estimator.machine.document import DocumentError, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.parameters import unknowns
from estimator.updated_model.model import expected_model
from formats.files.document_files import UnreadableFile, read_machine
from tests.estimator.long_trains import TRAINS
from tests.estimator.trains import Document, one_disc_document
from tests.paths import EXAMPLES


def sliced(sections: int, *, shafts: int = 1) -> Document:
    """One disc between two bearings on the first of some shafts, each in so many sections."""
    document = one_disc_document()
    document.pop("element_length")
    one = {"length": 1.0 / sections, "outer_diameter": 0.03, "material": "steel"}
    names = ["S", *(f"S{number}" for number in range(1, shafts))]
    document["shafts"] = [{"id": name, "sections": [one] * sections} for name in names]
    for part in (*document["bearings"], *document["discs"], *document["probes"]):
        part["station"] = min(part["station"], 0.999)
    return document


def rich() -> Document:
    """300 sections with everything that a document may leave open."""
    document = large_train(300, seed=1)
    for shaft in document["shafts"]:
        shaft["bow_spread"] = 1e-4
    for coupling in document["couplings"]:
        coupling["load"] = {"force_spread": 100.0, "moment_spread": 10.0}
    for probe in document["probes"]:
        probe.update(gain_spread=0.02, run_out_spread=1e-6)
    document["materials"]["steel"].update(young_modulus_spread=0.02, density_spread=0.01)
    return document


def refused(document: Any) -> dict[str, str]:
    with pytest.raises(DocumentError) as found:
        accepted_machine(document)
    return dict(found.value.problems)


@pytest.mark.parametrize("name", ["thesis-chapter-3", "motor-pump", "turbine-compressor-generator"])
def test_examples_pass(name: str) -> None:
    machine = read_machine(EXAMPLES / f"{name}.yaml")
    assert require_acceptable(machine) is machine
    assert most_samples(machine) == LARGEST_SAMPLE_COUNT


def test_an_honest_train_of_300_sections_passes() -> None:
    machine = accepted_machine(large_train(300, seed=1))
    assert (len(machine.bearings), len(machine.probes), len(machine.couplings)) == (20, 40, 8)
    assert document_size(machine).sections == 300
    assert most_samples(machine) > 2000


def test_a_train_of_300_sections_of_which_little_is_known_passes() -> None:
    assert FEWEST_SAMPLES <= most_samples(accepted_machine(rich())) < LARGEST_SAMPLE_COUNT


@pytest.mark.parametrize("document", [*[make() for make in TRAINS.values()], rich()], ids=[*TRAINS, "rich"])
def test_counts_are_those_of_the_model(document: Document) -> None:
    machine = parse_machine(document)
    rotor, size = assemble_rotor(machine), document_size(machine)
    assert size.elements == sum(len(stations) - 1 for stations in rotor.stations.values())
    assert size.coefficients == len(unknowns(machine, rotor).coefficients)
    channels = 2 * sum((probe.gain_spread > 0.0) + (probe.run_out_spread > 0.0) for probe in machine.probes)
    assert size.unknowns == len(expected_model(machine).coordinates) + channels


@pytest.mark.parametrize("document", [*[make() for make in TRAINS.values()], rich()], ids=[*TRAINS, "rich"])
def test_places_are_the_degrees_of_freedom_that_a_fit_retains(document: Document) -> None:
    machine = parse_machine(document)
    train = condense(machine, speed=np.array([100.0]), direction=np.ones(1))
    assert 2 * document_size(machine).places == train.output.shape[1]


def test_4000_sections_are_refused() -> None:
    """The document that took 7.5 GB: 20 shafts of 200 sections."""
    told = refused(sliced(200, shafts=20))
    assert told.keys() == {"shafts"}
    assert told["shafts"].startswith(f"4000 sections in all; at most {LARGEST_SECTIONS}")


def test_500_sections_are_refused_and_the_most_pass() -> None:
    """The document that kept /alive from answering for a minute."""
    assert "500 sections" in refused(sliced(100, shafts=5))["shafts"]
    accepted_machine(sliced(80, shafts=5))


def test_elements_are_counted_and_not_made() -> None:
    document = one_disc_document(element_length=1.01e-6)
    told = refused(document)["element_length"]
    assert f"at most {LARGEST_ELEMENTS}" in told
    assert int(told.split()[0]) == pytest.approx(1.0 / 1.01e-6, rel=0.01)


def test_elements_between_the_parts_count_too() -> None:
    document = large_train(300, seed=1)
    assert "element_length" in refused({**document, "element_length": 0.02})
    assert accepted_machine({**document, "element_length": 0.2}).element_length == 0.2


def test_a_speed_at_which_every_element_is_a_mode_is_refused() -> None:
    document = large_train(120, seed=1)
    document["speed_range"]["maximum_rpm"] = 1e9
    told = refused(document)
    assert told.keys() == {"speed_range.maximum_rpm"}
    assert "is the speed right?" in told["speed_range.maximum_rpm"]


def test_unknowns_are_bounded() -> None:
    document = large_train(300, seed=1)
    knots = {"form": "piecewise", "knots_rpm": [500 * (1 + number) for number in range(12)]}
    for bearing in document["bearings"]:
        bearing["speed_dependence"] = knots
    told = refused(document)["document"]
    assert told.startswith(f"{276 + 20 * 8 * 11} real unknowns; at most ")
    assert "knots_rpm" in told


def test_places_are_bounded() -> None:
    document = large_train(120, seed=1)
    document["probes"] = [
        {"id": f"P{number}", "shaft": "S1", "station": round(0.02 * (1 + number), 3), "angle_deg": 0} for number in range(115)
    ]
    assert "plane degrees of freedom; at most " in refused(document)["document"]


def test_all_together_is_bounded() -> None:
    document = rich()
    knots = {"form": "piecewise", "knots_rpm": [500, 1000, 2000, 3000]}
    for bearing in document["bearings"][:12]:
        bearing["speed_dependence"] = knots
    document["probes"] += [{**probe, "id": f"{probe['id']}{side}"} for probe in document["probes"] for side in "ab"]
    told = refused(document)["document"]
    assert f"at least {FEWEST_SAMPLES}" in told
    assert "fewer unknowns or fewer probes" in told


def test_what_is_wrong_beside_the_size_is_reported_first() -> None:
    document = sliced(200, shafts=20)
    document["bearings"][0]["shaft"] = "nowhere"
    assert list(refused(document)) == ["bearings[0].shaft"]


def test_a_file_is_refused_and_what_is_stored_is_read(tmp_path: Path) -> None:
    document = sliced(200, shafts=20)
    assert len(parse_machine(document).shafts) == 20
    file = tmp_path / "large.json"
    file.write_text(parse_machine(document).model_dump_json(), encoding="utf-8")
    with pytest.raises(UnreadableFile, match="shafts: 4000 sections in all; at most"):
        read_machine(file)


def on_films(count: int, *, differ: str) -> Document:
    """A shaft on some tilting-pad bearings, which differ in one number of their film."""
    document = read_machine(EXAMPLES / "turbine-on-tilting-pads.yaml").model_dump(mode="json")
    shaft, first = document["shafts"][0], document["bearings"][0]
    bearings = []
    for number in range(count):
        film = dict(first["film"])
        film[differ] = film[differ] * (1.0 + 0.005 * number)
        bearings.append({**first, "id": f"B{number}", "station": 0.05 + 0.09 * number, "film": film})
    discs = [one for one in document["discs"] if one["shaft"] == shaft["id"]]
    probes = [one for one in document["probes"] if one["shaft"] == shaft["id"]]
    gone: Document = {"couplings": [], "pedestals": [], "parameters": []}
    return document | gone | {"shafts": [shaft], "bearings": bearings, "discs": discs, "probes": probes}


def test_different_pads_are_counted_since_each_takes_seconds() -> None:
    assert document_size(accepted_machine(on_films(LARGEST_PADS, differ="length"))).pads == LARGEST_PADS
    assert "17 different pads; at most 16" in refused(on_films(LARGEST_PADS + 1, differ="length"))["bearings"]


def test_pads_that_differ_in_clearance_only_are_one() -> None:
    assert document_size(accepted_machine(on_films(20, differ="radial_clearance"))).pads == 1


def test_films_that_no_coefficients_follow_from_are_not_counted() -> None:
    document = on_films(20, differ="length")
    for bearing in document["bearings"]:
        bearing["speed_dependence"] = None
    assert document_size(accepted_machine(document)).pads == 0


def test_sharp_deviations_of_films_take_memory() -> None:
    known = DocumentSize(sections=10, elements=20, modes=5, coefficients=64, unknowns=480, probes=172, places=60, pads=0)
    assert known.samples > FEWEST_SAMPLES
    assert replace(known, pads=4).samples < FEWEST_SAMPLES
