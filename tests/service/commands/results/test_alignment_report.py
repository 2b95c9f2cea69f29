"""Alignment as the terminal shows it."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner

from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.alignment.load_change import LoadChange
from estimator.alignment.tolerance import ToleratedChange
from estimator.updated_model.derived_quantities import Derived
from service.commands.app import app
from service.commands.results.alignment_report import alignment_comparison_content, alignment_text
from tests.film_plant.documents import film_document, measured
from tests.film_plant.misalignment import moved
from tests.film_plant.plants import Priors, motor_compressor_plant
from tests.service.commands.recorded_run import write_run

OFFSET = re.compile(r"coupling\.C1\.offset_vertical +\+[\d.]+ µm \(\+([\d.]+) to \+([\d.]+)\)")


def test_offsets_are_reported_in_micrometres_with_their_interval_and_reasons_where_there_are_none() -> None:
    offset = Derived("coupling.C1.offset_vertical", "m", -83.2e-6, -151e-6, -15.4e-6)
    angle = Derived("coupling.C1.angle_vertical", "rad", None, None, None, "the prior alone")
    empty, heading, first, second = alignment_text([offset, angle]).split("\n")
    assert empty == ""
    assert "up and along +x are positive" in heading
    assert first == "coupling.C1.offset_vertical  -83 µm (-151 to -15)"
    assert second == "coupling.C1.angle_vertical   not determined: the prior alone"


def test_a_comparison_tells_what_has_moved_and_which_loads_in_words_and_as_json() -> None:
    moved_by = ToleratedChange("coupling.C1.offset_vertical", "m", -118e-6, 18e-6, 50e-6, 0.999)
    unknown = ToleratedChange("coupling.C1.angle_vertical", "rad", None, 0.0, 400e-6, 0.0, "the prior alone")
    load = LoadChange("bearing.B2.load_vertical", value=420.0, error=30.0, before=6000.0, carried=6010.0)
    across = LoadChange("bearing.B2.load_horizontal", value=-0.2, error=10.0, before=50.0, carried=6010.0)
    little = LoadChange("bearing.B3.load_horizontal", value=-0.2, error=0.002, before=50.0, carried=6010.0)
    found = AlignmentComparison("C1", (moved_by, unknown), (load, across, little))
    change = "-118 ± 18 µm (50 µm allowed, chance of more over 99 %)"
    assert found.verdict == f"the alignment of C1 has changed: vertical offset by {change}"
    assert list(found.lines()) == [
        f"  coupling.C1.offset_vertical  {change}",
        "  coupling.C1.angle_vertical   not determined: the prior alone",
        "  bearing.B2.load_vertical     +420 ± 59 N of 6000 N, +7 %",
        "  bearing.B2.load_horizontal   +0 ± 20 N of 50 N",
        "  bearing.B3.load_horizontal   -0.200 ± 0.004 N of 50 N",
    ]
    said = alignment_comparison_content(found)
    assert said["changes"][1]["change"] is None
    assert said["loads"][0]["change_per_cent"] == pytest.approx(7.0)
    assert said["loads"][1]["change_per_cent"] is None
    still = AlignmentComparison("C1", (replace(moved_by, value=10e-6), unknown), ())
    assert still.verdict == "no change of the alignment of C1 is certain"
    assert AlignmentComparison("C1", (unknown,), ()).verdict == "the run does not determine the alignment of C1"


def test_machines_without_films_have_no_such_lines() -> None:
    assert alignment_text([]) == ""


def test_an_identification_prints_the_offset_of_a_raised_shaft(tmp_path: Path) -> None:
    plant = motor_compressor_plant(3, "rigid", priors=Priors(clearance=0.05, viscosity=0.05, rigid_elevation=0.0))
    plant = replace(plant, train=moved(plant.train, offset=np.array([0.0, 60e-6]), angle=np.zeros(2)))
    document = film_document(plant, priors=Priors(elevation=150e-6, rigid_elevation=150e-6))
    (tmp_path / "machine.yaml").write_text(yaml.safe_dump(document))
    data, channels = measured(plant, seed=5), [one["id"] for one in document["probes"]]
    write_run(tmp_path / "run.csv", data.speed, 1e6 * data.phasor, channels=channels, plant="films", machine=document["id"])
    found = CliRunner().invoke(app, ["identify", str(tmp_path / "machine.yaml"), str(tmp_path / "run.csv"), "--no-gate"])
    assert found.exit_code == 0, found.output
    told = OFFSET.search(found.output)
    assert told is not None, found.output
    assert float(told[1]) < 60.0 < float(told[2])
    assert "coupling.C1.angle_horizontal" in found.output
