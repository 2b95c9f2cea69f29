"""Alignment told from an identification: values, errors from the whole covariance, and what the run does not determine."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.machine.document import Machine, parse_machine
from estimator.rotor.parameter_names import derived_unit
from estimator.updated_model.alignment_results import AlignmentResult, alignment_results
from estimator.updated_model.derived_quantities import Derived, model_quantities
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.models import rich_model
from tests.estimator.statics.films import motor_compressor_document
from tests.estimator.updated_model.propagation import propagated
from tests.film_plant.motor_compressor import ANGLE, PARALLEL, CouplingKind

SPREAD = 150e-6
NAMES = tuple(f"coupling.C1.{what}" for what in ("offset_vertical", "offset_horizontal", "angle_vertical", "angle_horizontal"))


def machine_of(kind: CouplingKind = "flexible", case: str = "aligned") -> Machine:
    said = motor_compressor_document(kind, case)
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal", "elevation_spread": SPREAD}
    return parse_machine(said)


def by_name(model: UpdatedModel) -> dict[str, AlignmentResult]:
    return {one.name: one for one in alignment_results(model)}


def told(model: UpdatedModel) -> dict[str, Derived]:
    return {one.name: one for one in model_quantities(model, speed=300.0) if one.name in NAMES}


def elevations(model: UpdatedModel) -> list[int]:
    """Places of the elevations along y, bearing by bearing."""
    return [model.coordinates.index(f"bearing.B{number}.elevation_y") for number in range(1, 5)]


def before(model: UpdatedModel) -> UpdatedModel:
    """The model with the covariance that is believed of its films before any run, and nothing else uncertain."""
    coordinates = model.coordinates_at(np.array([100.0]))
    films = np.arange(coordinates.size) < len(coordinates.parameters)
    return replace(model, covariance=np.diag(np.where(films, coordinates.spread * coordinates.unit, 0.0) ** 2))


def with_known_offset(model: UpdatedModel, error: float) -> UpdatedModel:
    """The believed covariance after one measurement of the vertical offset with an error, and nothing else."""
    prior = before(model)
    row = by_name(prior)["coupling.C1.offset_vertical"].slope
    gain = prior.covariance @ row / (row @ prior.covariance @ row + error**2)
    return replace(prior, covariance=prior.covariance - np.outer(gain, row @ prior.covariance))


@pytest.mark.parametrize("kind", ["flexible", "rigid"])
@pytest.mark.parametrize("case", ["parallel_up", "parallel_down", "angle_100urad"])
def test_of_the_document_alone_it_is_what_its_elevations_say(kind: CouplingKind, case: str) -> None:
    found = by_name(expected_model(machine_of(kind, case)))
    offset = {"parallel_up": PARALLEL[kind], "parallel_down": -PARALLEL[kind]}.get(case, 0.0)
    expected = [offset, 0.0, -ANGLE if case == "angle_100urad" else 0.0, 0.0]
    assert tuple(found) == NAMES
    assert [one.value for one in found.values()] == pytest.approx(expected, abs=1e-12)
    assert [one.unit for one in found.values()] == ["m", "m", "rad", "rad"]


def test_horizontal_and_vertical_have_their_own_elevations_and_signs() -> None:
    model = expected_model(machine_of())
    values = model.values.copy()
    for number, place in enumerate(elevations(model)):
        values[place] += 40e-6 if number >= 2 else 0.0
        values[model.coordinates.index(f"bearing.B{number + 1}.elevation_x")] += 70e-6 if number < 2 else 0.0
    found = by_name(replace(model, values=values))
    assert found["coupling.C1.offset_vertical"].value == pytest.approx(40e-6)
    assert found["coupling.C1.offset_horizontal"].value == pytest.approx(-70e-6)
    assert found["coupling.C1.angle_vertical"].value == pytest.approx(0.0, abs=1e-12)


def test_errors_are_those_of_differences_and_believed_ones_those_of_the_elevations() -> None:
    model = with_known_offset(expected_model(machine_of()), 20e-6)
    found = alignment_results(model)
    expected = np.sqrt(np.diag(propagated(lambda one: np.array([each.value for each in alignment_results(one)]), model)))
    assert [one.error for one in found] == pytest.approx(expected, rel=1e-6)
    lever = np.array([0.12 / 1.38, 1.0 + 0.12 / 1.38, 1.0 + 0.1 / 1.36, 0.1 / 1.36])
    assert found[0].believed == pytest.approx(SPREAD * np.linalg.norm(lever))


def test_an_offset_is_told_where_no_elevation_is_known() -> None:
    """The offset is measured to 20 µm: each elevation by itself stays nearly as open as before, and the offset is known."""
    model = with_known_offset(expected_model(machine_of()), 20e-6)
    single = np.sqrt(np.diag(model.covariance))[elevations(model)]
    assert single.min() > 0.7 * SPREAD
    found = told(model)["coupling.C1.offset_vertical"]
    assert found.value == pytest.approx(0.0, abs=1e-12)
    assert found.lower is not None
    assert found.upper is not None
    assert found.upper - found.lower == pytest.approx(2 * 1.96 * 20e-6, rel=0.02)


def test_what_the_run_does_not_determine_is_said() -> None:
    found = told(with_known_offset(expected_model(machine_of()), 20e-6))
    for name in NAMES[1:]:
        assert found[name].value is None
        assert "hardly more of it than what is believed beforehand: ± " in (found[name].reason or "")
    assert (found["coupling.C1.angle_vertical"].reason or "").endswith(" 220 µrad")


def test_names_and_units_are_known_by_the_document_alone() -> None:
    model = with_known_offset(expected_model(machine_of()), 20e-6)
    assert {name: derived_unit(model.machine, name) for name in NAMES} == {name: one.unit for name, one in told(model).items()}


def test_trains_without_films_have_none() -> None:
    assert alignment_results(rich_model()) == ()
