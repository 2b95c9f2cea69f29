"""Saved ROSS models as machines: what is taken, and what is refused in words."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rotorundown as rd
from estimator.machine.document import Machine
from rotorundown.ross.models import WrongROSSModel
from tests.paths import DATA

FILE = DATA / "ross-rotor.toml"
PROBES = [{"id": "P1X", "station": 0.1, "angle_deg": 45}, {"id": "P1Y", "station": 0.1, "angle_deg": 135}]


def read(file: Path = FILE, **changes: Any) -> Machine:
    return rd.read_ross_model(file, **({"machine": "fan", "probes": PROBES, "speed_range_rpm": (300, 3000)} | changes))


def test_shaft_discs_bearings_and_seals_are_taken() -> None:
    machine = read()
    (shaft,) = machine.shafts
    assert [(one.length, one.outer_diameter, one.inner_diameter) for one in shaft.sections] == [
        (0.5, 0.05, 0.0),
        (0.25, 0.07, 0.0),
        (0.25, 0.05, 0.0),
    ]
    (material,) = machine.materials.values()
    assert material.poisson_ratio == pytest.approx(211.0 / (2 * 81.2) - 1.0)
    (disc,) = machine.discs
    assert (disc.id, disc.station, disc.mass, disc.polar_inertia) == ("Disk-0", 0.5, 32.6, 0.33)
    constant, table = machine.bearings
    assert (constant.id, constant.kxy, constant.kyx, constant.cyy) == ("Bearing-0", 1e4, -1e4, 900.0)
    assert table.station == 1.0
    law: Any = table.speed_dependence
    assert law.speed_rpm[1] == pytest.approx(100.0 * 30 / np.pi)
    assert law.kxx == (1e6, 1.1e6, 1.2e6, 1.3e6, 1.4e6)
    (seal,) = machine.seals
    assert (seal.mxx, seal.kyy, seal.station) == (3.0, 2e5, 0.75)


def test_its_critical_speeds_follow() -> None:
    first, *_ = rd.model(read()).critical_speeds()
    # The disc alone on the shaft's and the bearings' springs in series lies above: the shaft has mass, too.
    inertia = np.pi * 0.05**4 / 64
    shaft = 48 * 211e9 * inertia / 1.0**3
    above = np.sqrt(1 / (1 / shaft + 1 / 1.8e6) / 32.6)
    assert 0.6 * above < first.speed_rpm * np.pi / 30 < 1.2 * above


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("odr = 0.05", "odr = 0.06", "'Shaft 0' is conical"),
        ("axial_force = 0", "axial_force = 10.0", "'Shaft 0' has axial_force = 10.0"),
        ("beta = 0.0", "beta = 0.001", "'Shaft 0' has beta = 0.001"),
        ("idl = 0.05", "idl = 0.06", "'Shaft 2' and 'Sleeve 2' are layers that do not touch"),
        ('n = 3\ntag = "Shaft 3"', 'n = 5\ntag = "Shaft 3"', "its shaft has a gap"),
        ("n = 2\nm = 32.6", "n = 9\nm = 32.6", "'Disk 0' sits at node 9, which the shaft does not have: it has 0 to 4"),
        ("mxx = [0]", "mxx = [5.0]", "'Bearing 0' has mxx"),
        ("kzz = [0]", "n_link = 7", "'Bearing 0' stands on another element"),
        ("frequency = [10.0, 100.0", "frequency = [100.0", "need one value at each of its 4 frequencies"),
        ("DiskElement_Disk 0", "PointMass_Disk 0", "PointMass 'Disk 0' cannot be described"),
        ("G_s = 81.2e9\ncolor", "color", "has no number G_s"),
        ('ross_version = "2.0.0"', "[x]", "'x' is no element"),
        ("[parameters]", "[parameters", "is no TOML"),
    ],
)
def test_what_cannot_be_described_is_refused_in_words(tmp_path: Path, before: str, after: str, words: str) -> None:
    text = FILE.read_text()
    assert before in text
    file = tmp_path / "model.toml"
    file.write_text(text.replace(before, after, 1))
    with pytest.raises(WrongROSSModel, match="(?s)" + words.replace("[", r"\[")):
        read(file)


def test_wrong_probes_and_missing_files_are_named(tmp_path: Path) -> None:
    with pytest.raises(WrongROSSModel, match=r"probes\[0\].station"):
        read(probes=[{"id": "P", "station": -1.0, "angle_deg": 0}])
    with pytest.raises(WrongROSSModel, match="No such file"):
        read(tmp_path / "missing.toml")
