"""Alignment found on misaligned plants of other make: offsets with intervals that hold, what is not determined, changes."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from estimator.alignment.alignment_change import alignment_changes
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.statics.alignment import coupling_alignments
from estimator.updated_model.derived_quantities import Derived, derived_quantities
from estimator.updated_model.model import updated_model
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.misalignment import SETTLED, left_off, moved, true_alignment
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Priors, motor_compressor_plant
from tests.film_plant.scatter import run_of

WIDE = Priors(elevation=150e-6, rigid_elevation=150e-6)
OPTIONS = Options(starts=2)
SEEDS = {"flexible": 1, "rigid": 2}
"""Plants whose couplings are far off."""


def plant_of(kind: CouplingKind, seed: int) -> Plant:
    return motor_compressor_plant(seed, kind, priors=SETTLED, discrepancy=DiscrepancySize(), alter=left_off(kind))


def machine_of(plant: Plant) -> Machine:
    return parse_machine(film_document(plant, priors=WIDE))


@cache
def fitted(kind: CouplingKind) -> tuple[Plant, Identification]:
    plant = plant_of(kind, SEEDS[kind])
    return plant, identify(machine_of(plant), measured(plant, seed=SEEDS[kind]), OPTIONS)


def told(plant: Plant, found: Identification) -> dict[str, Derived]:
    return {one.name: one for one in derived_quantities(machine_of(plant), found) if one.name.startswith("coupling.C1.")}


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
def test_the_plants_own_levers_say_what_the_estimators_say(kind: CouplingKind) -> None:
    plant = plant_of(kind, SEEDS[kind])
    (one,) = coupling_alignments(machine_of(plant))
    off = plant.train.elevations - plant.believed.elevations
    true = true_alignment(plant)
    for plane, axis in (("vertical", 1), ("horizontal", 0)):
        assert one.offset @ off[:, axis] == pytest.approx(true[f"coupling.C1.offset_{plane}"].real)
        assert one.angle @ off[:, axis] == pytest.approx(true[f"coupling.C1.angle_{plane}"].real)


@pytest.mark.parametrize(("kind", "widest"), [("flexible", 160e-6), ("rigid", 17e-6)])
def test_offsets_are_found_with_intervals_that_hold(kind: CouplingKind, widest: float) -> None:
    plant, found = fitted(kind)
    assert found.accepted, found.verdict
    true, said = true_alignment(plant), told(plant, found)
    for name in ("coupling.C1.offset_vertical", "coupling.C1.offset_horizontal"):
        one = said[name]
        assert one.lower is not None
        assert one.upper is not None
        half = (one.upper - one.lower) / 2
        assert half < widest
        assert one.lower < true[name].real < one.upper
        assert abs(true[name]) > half, "zero would do as well"


def test_across_a_flexible_coupling_the_angle_is_not_determined_and_across_a_rigid_one_it_is() -> None:
    angle = told(*fitted("flexible"))["coupling.C1.angle_vertical"]
    assert angle.value is None
    assert angle.reason is not None
    assert "hardly more of it than what is believed beforehand" in angle.reason
    plant, found = fitted("rigid")
    rigid = told(plant, found)["coupling.C1.angle_horizontal"]
    assert rigid.lower is not None
    assert rigid.upper is not None
    assert rigid.lower < true_alignment(plant)["coupling.C1.angle_horizontal"].real < rigid.upper


def test_a_change_is_known_better_than_either_offset() -> None:
    """Shaft 2 sinks by 50 µm across the flexible coupling, with the oil and the films of another run."""
    plant, _ = fitted("flexible")
    machine, rng = machine_of(plant), np.random.default_rng(3)
    later = replace(plant, train=moved(plant.train, offset=np.array([0.0, -50e-6]), angle=np.zeros(2)))
    runs = [run_of(plant, rng), run_of(plant, rng), run_of(later, rng)]
    fits = [identify(machine, measured(one, seed=number), OPTIONS) for number, one in enumerate(runs)]
    models = [updated_model(machine, one) for one in fits]
    (vertical, horizontal, *_) = alignment_changes(models[:-1], models[-1])
    assert vertical.value == pytest.approx(-50e-6, abs=3 * vertical.error)
    assert horizontal.value == pytest.approx(0.0, abs=3 * horizontal.error)
    assert 1.96 * vertical.error < 26e-6
    single = told(plant, fits[-1])["coupling.C1.offset_vertical"]
    assert single.upper is not None
    assert single.value is not None
    assert 1.96 * vertical.error < 0.5 * (single.upper - single.value)
