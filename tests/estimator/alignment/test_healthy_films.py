"""Tests how a healthy train varies: learnt from its baseline, shrunk to what is stated, in groups that share a size."""

from typing import Any

import numpy as np
import pytest

from estimator.alignment.healthy_films import (
    coordinate_scales,
    learnt_variation,
    machine_precision,
    machine_spread,
    stated_variation,
)
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.calibration import Calibration
from estimator.machine.document import parse_machine
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted, place
from tests.estimator.models import rich_model
from tests.estimator.statics.films import motor_compressor_document
from tests.film_plant.documents import film_document
from tests.film_plant.plants import mixed_plant

STATED = HealthyVariation()


def baseline(true: HealthyVariation, *, runs: int, seed: int = 0) -> HealthyVariation:
    rng = np.random.default_rng(seed)
    machine = drawn_machine(rng)
    return learnt_variation([fitted(drawn_run(machine, true, rng), rng) for _ in range(runs)])


def test_a_machine_that_varies_as_stated_is_told_so() -> None:
    found = baseline(STATED, runs=6)
    for number in ("stiffness", "damping", "oil", "unbalance"):
        assert getattr(found, number) == pytest.approx(getattr(STATED, number), rel=0.35)


def test_a_machine_that_varies_more_is_learnt_in_part() -> None:
    """Six runs against what counts as ten: a third of the way of the variance or so."""
    true = STATED.model_copy(update={"stiffness": 0.03, "damping": 0.15})
    few, many = baseline(true, runs=6), baseline(true, runs=30)
    for number in ("stiffness", "damping"):
        stated, wide = getattr(STATED, number), getattr(true, number)
        assert 1.3 * stated < getattr(few, number) < getattr(many, number) < 1.1 * wide
    assert few.slow_oil == STATED.slow_oil


def test_unbalances_that_stay_are_learnt_faster_than_films() -> None:
    """Each run shows all of their components: six runs take most of the way, where films take a third of it."""
    true = STATED.model_copy(update={"unbalance": 0.005, "stiffness": 0.002})
    found = baseline(true, runs=6)
    assert true.unbalance < found.unbalance < 0.55 * STATED.unbalance
    assert found.stiffness > 0.75 * STATED.stiffness


def test_what_is_stated_as_nothing_stays_nothing() -> None:
    rng = np.random.default_rng(1)
    still = HealthyVariation.model_validate(dict.fromkeys(HealthyVariation.model_fields, 0.0))
    operation = MODEL.machine.operation.model_copy(update={"healthy_variation": still})
    machine = MODEL.machine.model_copy(update={"operation": operation})
    runs = [fitted(drawn_machine(rng), rng) for _ in range(2)]
    models = [type(one)(machine, one.coordinates, one.values, one.covariance) for one in runs]
    assert learnt_variation(models) == still


def test_oil_goes_together_and_elevations_grow_over_the_seasons() -> None:
    scales = coordinate_scales(COORDINATES, MODEL.values)
    first, second = place("bearing.B1.viscosity"), place("bearing.B4.viscosity")
    runs, season = scales.between_runs(STATED), scales.over_seasons(STATED)
    assert runs[first, second] == pytest.approx(STATED.oil**2)
    assert season[first, second] == pytest.approx(STATED.slow_oil**2)
    lifted = place("bearing.B2.elevation_y")
    assert np.sqrt(season[lifted, lifted]) * COORDINATES.unit[lifted] == pytest.approx(STATED.slow_elevation)
    assert season[place("bearing.B1.clearance"), first] == 0.0


def test_what_is_believed_of_a_machine_is_that_of_a_run_without_what_varies_between_runs() -> None:
    """The scatter of each run by itself makes up the rest."""
    scales = coordinate_scales(COORDINATES, MODEL.values)
    machine = machine_spread(COORDINATES)
    varying = place("films.B1.cxx_deviation0")
    assert COORDINATES.spread[varying] == pytest.approx(np.hypot(machine[varying], scales.own(STATED)[varying]))
    assert machine[varying] == 1.0
    others = [k for k, name in enumerate(COORDINATES.names) if ".cxx_dev" not in name and ".cyy_dev" not in name]
    np.testing.assert_allclose(machine[others], COORDINATES.spread[others])
    np.testing.assert_allclose(machine_precision(COORDINATES), np.diag(machine**-2.0))


def test_of_what_varies_between_runs_a_calibration_says_what_its_runs_have_in_common() -> None:
    known = {"films.B1.cxx_deviation0": 0.3, "films.B1.kxx_deviation0": 0.2, "bearing.B1.clearance": 0.01}
    calibration = Calibration(
        parameters=tuple(known), values=(0.5, 0.5, np.log(1e-4)), covariance=tuple(np.diag(np.square(list(known.values()))))
    )
    calibrated = expected_model(MODEL.machine.model_copy(update={"calibration": calibration})).coordinates_at(np.ones(1))
    places = [place(name) for name in known]
    np.testing.assert_allclose(machine_spread(calibrated)[places], list(known.values()))
    scatter = coordinate_scales(COORDINATES, MODEL.values).own(STATED)[places[0]]
    np.testing.assert_allclose(calibrated.spread[places], [np.hypot(0.3, scatter), 0.2, 0.01])


def test_coefficients_of_bearings_beside_films_vary_as_those_of_couplings() -> None:
    table, rolling = (updated_models_of_mixed(seed) for seed in (1, 0))
    for model, kyy, cyy in (
        (table, "bearing.B1.kyy_scale", "bearing.B1.cyy_scale"),
        (rolling, "bearing.B1.kyy", "bearing.B1.cyy"),
    ):
        scales = coordinate_scales(model.coordinates_at(np.ones(1)), model.values)
        names = list(model.coordinates)
        assert (scales.numbers[names.index(kyy)], scales.numbers[names.index(cyy)]) == ("stiffness", "damping")
        assert scales.numbers[names.index("bearing.B2.elevation_y")] == "elevation"


def updated_models_of_mixed(seed: int) -> UpdatedModel:
    """The model, as believed, of a train of which one shaft runs on films."""
    return expected_model(parse_machine(film_document(mixed_plant(seed))))


def test_where_the_temperature_is_measured_the_season_is_known() -> None:
    said: dict[str, Any] = motor_compressor_document("flexible", "aligned")
    said["conditions"] = [{"name": "oil", "unit": "degC"}]
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal"}
        bearing["film"]["oil"] = {"iso_vg": 46, "temperature_c": 50.0, "temperature_from": "oil"}
    assert stated_variation(parse_machine(said)).slow_oil == 2 * STATED.oil
    assert stated_variation(MODEL.machine).slow_oil == STATED.slow_oil


def test_other_trains_have_no_such_coordinates() -> None:
    model = rich_model()
    with pytest.raises(ValueError, match="only coordinates of a train on oil films"):
        coordinate_scales(model.coordinates_at(np.ones(1)), model.values)
