"""Tests where the parts of a train lie."""

import math

import pytest

from estimator.machine.parts import Disc
from estimator.machine.train_layout import STEEL, disc_body, shaft_begins
from tests.plant import document
from tests.plant import machine as plant_machine


def test_shafts_follow_each_other_from_driver_to_driven_whatever_their_order() -> None:
    given = document()
    shafts = [
        {"id": name, "sections": [{"length": length, "outer_diameter": 0.04, "material": "steel"}]}
        for name, length in (("S3", 0.3), ("S1", 0.6), ("S2", 0.7))
    ]
    couplings = [given["couplings"][0] | {"id": "C2", "driver": "S2", "driven": "S3"}, given["couplings"][0]]
    found = shaft_begins(plant_machine(shafts=shafts, couplings=couplings))
    assert list(found) == ["S1", "S2", "S3"]
    assert found == pytest.approx({"S1": 0.0, "S2": 0.6, "S3": 1.3})


def test_a_disc_is_as_large_as_its_mass_and_inertia_say() -> None:
    radius, width = 0.2, 0.05
    mass = STEEL * math.pi * radius**2 * width
    inertia = mass * radius**2 / 2
    disc = Disc(id="D1", shaft="S1", station=0.1, mass=mass, diametral_inertia=inertia / 2, polar_inertia=inertia)
    assert disc_body(disc).radius == pytest.approx(radius)
    assert disc_body(disc).width == pytest.approx(width)
    assert disc_body(disc.model_copy(update={"polar_inertia": 0.0})).radius is None
