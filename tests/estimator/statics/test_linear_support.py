"""Bearings with coefficients of their own beside others on films: statics in closed form, derivatives, fits, refusals."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from benchmarks.fluid_film.film_fits import as_drawn
from benchmarks.fluid_film.film_trials import film_trial
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import DocumentError, parse_machine
from estimator.machine.films import Elevation
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameter_names import derived_units, parameter_units
from estimator.rotor.parameters import unknowns
from estimator.simulation.simulated_plant import draw_truth, true_phasors, truth_of_run
from estimator.statics.coupled_train import train_statics
from estimator.statics.equilibrium import FilmTrain, film_train
from estimator.statics.film_model import film_model
from estimator.statics.linear_support import linear_support
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import updated_model
from estimator.updated_model.shaft_line import modelled_lines
from tests.estimator.statics.films import between_two_bearings
from tests.estimator.statics.test_film_model import SPEED, drawn
from tests.estimator.statics.test_film_model import document as on_films
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plants import mixed_plant
from tests.film_plant.proportions import Design
from tests.film_plant.scores import film_truths
from tests.film_plant.wrong_documents import supports_off

CENTRE = 0.5 * 200.0 * 9.81
"""Load of the symmetric rotor on each of its bearings, its shaft aside [N]."""
KNOTS = {"form": "piecewise", "knots_rpm": [1000.0, 2500.0, 4000.0], "coefficients": ["kyy", "kxy"]}
TABLE = {
    "form": "table",
    "speed_rpm": [500.0, 1500.0, 2500.0, 3500.0, 5000.0],
    "kxx": [4e7, 3.5e7, 3.2e7, 3e7, 2.8e7],
    "kxy": [1e6, 2e6, 3e6, 4e6, 5e6],
    "kyx": [-2e6, -3e6, -4e6, -5e6, -6e6],
    "kyy": [6e7, 5.5e7, 5.2e7, 5e7, 4.8e7],
    "scale_spread": 0.1,
}


def mixed(*, own: tuple[dict[str, Any], dict[str, Any]] = ({}, {}), **form: Any) -> dict[str, Any]:
    """The motor and compressor whose driver runs on bearings with coefficients of their own."""
    said = on_films(**form)
    for bearing, changed in zip(said["bearings"], own, strict=False):
        del bearing["film"], bearing["speed_dependence"]
        bearing |= {"kxx": 5e7, "kyy": 8e7, "kxy": 5e6, "kyx": -8e6, "cxx": 1e5, "cyy": 1e5, "cxy": 0.0, "cyx": 0.0}
        bearing["elevation"] = {"y": 2e-5, "spread": 3e-5}
        of_form = changed.get("speed_dependence", {})
        for term in set(bearing) & set(of_form):
            del bearing[term]
        bearing |= changed
    return said


def test_a_rotor_between_a_film_and_a_stiff_support_loads_its_film_as_between_two_films() -> None:
    pure = film_train(between_two_bearings())
    said = between_two_bearings().model_dump(mode="json", exclude_none=True)
    said["bearings"][0] |= {"speed_dependence": {"form": "journal"}}
    del said["bearings"][1]["film"]
    said["bearings"][1] |= {"kxx": 1e13, "kyy": 1e13}
    train = film_train(parse_machine(said))
    assert (list(train.journals), list(train.supports)) == ([0], [1])
    for speed in (100.0, 500.0):
        expected, found = pure.equilibrium(speed), train.equilibrium(speed)
        assert expected is not None
        assert found is not None
        np.testing.assert_allclose(found.force, expected.force, atol=1e-5 * CENTRE)
        np.testing.assert_allclose(found.position[0], expected.position[0], rtol=1e-5, atol=1e-11)
        np.testing.assert_allclose(found.position[1], 0.0, atol=1e-9)
        np.testing.assert_allclose(found.stiffness[1], np.diag([1e13, 1e13]), atol=0.0)


def test_a_beam_on_three_springs_of_which_the_middle_one_is_raised() -> None:
    """Bernoulli's beam, thin enough: F of the middle from rise = F ((2 l)³/48EI + 1/k + 1/2k); at rest no spring counts."""
    diameter, span, stiffness, rise = 0.02, 1.0, 3e5, 1e-3
    said = between_two_bearings().model_dump(mode="json", exclude_none=True)
    said["shafts"][0]["sections"] = [{"length": 2 * span, "outer_diameter": diameter, "material": "light"}]
    said["discs"][0]["station"] = span
    lateral = {"kxx": stiffness, "kyy": stiffness, "kxy": 0.0, "kyx": 0.0, "cxx": 1.0, "cyy": 1.0, "cxy": 0.0, "cyx": 0.0}
    said["bearings"] = [{"id": f"B{k}", "shaft": "S", "station": k * span, **lateral} for k in range(3)]
    machine = parse_machine(said)
    statics = train_statics(machine)
    at_rest = statics.film_force(statics.aligned)
    coefficients = unknowns(machine, assemble_rotor(machine)).coefficients
    supports = tuple(
        linear_support(one.id, Elevation(y=rise * (k == 1)), load=force, coefficients=coefficients)
        for k, (one, force) in enumerate(zip(machine.bearings, at_rest, strict=True))
    )
    found = FilmTrain(statics, supports, statics.aligned + np.array([one.raised for one in supports])).equilibrium(100.0)
    assert found is not None
    bending = machine.materials["light"].young_modulus * math.pi * diameter**4 / 64
    more = rise / ((2 * span) ** 3 / (48 * bending) + 1.5 / stiffness)
    np.testing.assert_allclose(found.force[:, 1] - at_rest[:, 1], [-more / 2, more, -more / 2], rtol=1e-3)
    np.testing.assert_allclose(found.position[:, 1], -(found.force - at_rest)[:, 1] / stiffness, rtol=1e-9)
    assert found.force[:, 1].sum() == pytest.approx(at_rest[:, 1].sum(), rel=1e-9)


@pytest.mark.parametrize("own", [({}, {}), ({"speed_dependence": KNOTS}, {"speed_dependence": TABLE})])
def test_derivatives_by_all_that_loads_follow_from_are_those_of_differences(own: Any) -> None:
    model = film_model(parse_machine(mixed(own=own, discrepancy=0.0)))
    curves, fitted = model.at(SPEED), drawn(model, 2)
    assert {one.rpartition(".")[0] for one in model.coefficients} == {"bearing.B3", "bearing.B4"}
    found, size = curves.derivatives(fitted, slice(None)), np.abs(curves.values(fitted)).max(axis=0)
    moved = {}
    for place, one in enumerate(model.numbers):
        step = np.zeros(fitted.size)
        step[place] = 1e-3 if one.name.startswith("coupling.") else 1e-2
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / (2 * step[place])
        np.testing.assert_allclose(found[:, :, place] / size, difference / size, atol=3e-4, rtol=2e-3, err_msg=one.name)
        moved[one.name] = float(np.abs(found[:, :, place] / size).max())
    stiffest = "bearing.B2.kyy_scale" if "speed_dependence" in own[1] else "bearing.B2.kyy"
    assert moved[stiffest] > 1e-3, moved
    assert moved["bearing.B2.elevation_y"] > 1e-2


def test_a_tied_support_follows_the_numbers_of_its_leader() -> None:
    said = mixed() | {"parameters": [{"names": "bearing.B2.*", "tied_to": "bearing.B1"}]}
    model = film_model(parse_machine(said))
    assert [one for one in model.read if one.endswith(".kyy")] == ["coupling.C1.kyy", "bearing.B1.kyy"]
    fitted = np.array([one.centre for one in model.numbers])
    fitted[model.read.index("bearing.B1.kyy")] = math.log(2.0)
    for support in model.own.changed(fitted).supports.values():
        assert support.at(np.zeros(2), speed=100.0).stiffness[1, 1] == pytest.approx(1.6e8)


@pytest.mark.parametrize("plants", [range(2), pytest.param(range(2, 6), marks=pytest.mark.long)])
def test_trains_on_films_and_other_bearings_are_identified_and_intervals_hold(plants: range) -> None:
    """Rolling elements and tables, at the driver and at the driven shaft, from a plant that shares no code."""
    held: list[bool] = []
    for seed in plants:
        found = film_trial(mixed_plant(seed, discrepancy=DiscrepancySize()), seed=seed, document=as_drawn)
        assert found.accepted, found.verdict
        assert found.took < 5.0
        held += (one for each in found.inside.values() for one in each)
    assert len(held) > 50 * len(plants)
    assert 0.88 < np.mean(held) <= 1.0


@pytest.mark.long
def test_trains_that_run_on_tilting_pads_beside_other_bearings_are_accepted_and_hold() -> None:
    """Rolling elements beside pads, and a table whose kxy is all but nothing: what is asked of that is something else's."""
    held: list[bool] = []
    for seed in (2, 3):
        plant = mixed_plant(seed, discrepancy=DiscrepancySize(), design=Design(profile="five_pads", slenderness=(0.5,)))
        found = film_trial(plant, seed=seed, document=as_drawn)
        assert found.accepted, found.verdict
        held += (one for each in found.inside.values() for one in each)
    assert len(held) > 150
    assert np.mean(held) >= 0.9


def test_a_table_beside_films_that_seems_off_by_less_than_a_per_cent_widens_the_intervals() -> None:
    found = film_trial(mixed_plant(31, discrepancy=DiscrepancySize()), seed=31, document=as_drawn)
    assert found.accepted, found.verdict
    assert "beside oil films that deviate themselves: intervals are widened" in found.verdict


@pytest.mark.long
def test_a_table_beside_films_that_is_off_by_two_spreads_as_a_whole_is_told_and_intervals_hold() -> None:
    held: list[bool] = []
    for seed in (3001, 3005):
        plant = mixed_plant(seed, discrepancy=DiscrepancySize(), supports=supports_off)
        found = film_trial(plant, seed=seed, document=as_drawn)
        assert found.accepted, found.verdict
        assert "more than its scale_spread of 15 % says" in found.verdict
        held += (one for each in found.inside.values() for one in each)
    assert np.mean(held) >= 0.9


def test_a_table_beside_films_that_is_far_off_over_speed_is_refused() -> None:
    plant = mixed_plant(1, discrepancy=DiscrepancySize())
    said = as_drawn(plant, 1)
    for bearing in said["bearings"]:
        table = bearing["speed_dependence"]
        if table["form"] == "table":
            table["kyy"] = [value * factor for value, factor in zip(table["kyy"], np.linspace(0.8, 1.25, 13), strict=True)]
    found = identify(parse_machine(said), measured(plant, seed=1), Options(starts=1))
    assert not found.accepted


def test_results_tell_loads_of_all_bearings_and_journals_of_films_only() -> None:
    plant = mixed_plant(0)
    machine = parse_machine(film_document(plant))
    outcome = identify(machine, measured(plant, seed=1), Options(starts=1))
    assert outcome.accepted, outcome.verdict
    model = updated_model(machine, outcome)
    results = {one.name: one for one in film_results(model)}
    units, derived = parameter_units(machine), derived_units(machine)
    assert all(derived[name] == one.unit for name, one in results.items())
    assert all(units[one.name] == one.unit for one in outcome.estimates)
    assert {name.split(".")[1] for name in results if name.endswith("load_vertical")} == {"B1", "B2", "B3", "B4"}
    assert {name.split(".")[1] for name in results if "journal_y" in name or "eccentricity" in name} == {"B3", "B4"}
    lines = modelled_lines(model, speed=np.array([plant.fastest]))
    assert lines is not None
    assert lines.bearings == ("B3", "B4")
    assert np.isfinite(lines.clearance).all()
    truth = film_truths(plant)
    for name in ("bearing.B1.kyy", "bearing.B2.kxx"):
        (one,) = (each for each in outcome.estimates if each.name == name)
        assert one.value == pytest.approx(truth[name].real, rel=0.05)


@pytest.mark.parametrize("own", [({}, {}), ({"speed_dependence": KNOTS}, {"speed_dependence": TABLE})])
def test_a_mixed_train_is_simulated_with_loads_that_follow_its_true_stiffness(own: Any) -> None:
    said = mixed(own=own, discrepancy=0.0)
    for disc in said["discs"]:
        disc["unbalance"] = {"magnitude": 1e-3, "angle_deg": 0.0}
    machine = parse_machine(said)
    rng = np.random.default_rng(1)
    truth = draw_truth(machine, rng)
    run = truth_of_run(truth, rng)
    assert run.films is not None
    supports = run.films.model.own.changed(run.films.fitted).supports
    true = dict(zip((one.name for one in run.unknowns.coefficients), run.coefficients, strict=True))
    middle = np.pi / 30 * machine.speed_range.middle_rpm
    assert supports[1].at(np.zeros(2), speed=middle).stiffness[1, 1] == pytest.approx(true["bearing.B2.kyy"], rel=1e-6)
    assert np.isfinite(true_phasors(machine, run, SPEED)).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda said: said["bearings"][0].pop("kyy"), "needs a value: loads on the films beside it"),
        (lambda said: said["bearings"][2].update(elevation={"y": 1e-5}), "film.elevation_x, film.elevation_y"),
        (
            lambda said: said.update(parameters=[{"names": "bearing.B1.*", "tied_to": "bearing.B3"}]),
            "'bearing.B3' is on a film",
        ),
        (lambda said: said["bearings"][0]["elevation"].update(spread=30.0), "spread"),
    ],
)
def test_a_mixed_document_that_leaves_loads_open_is_refused(change: Callable[[Any], object], words: str) -> None:
    said = mixed()
    parse_machine(said)
    change(said)
    with pytest.raises(DocumentError, match=words):
        parse_machine(said)


def test_an_elevation_from_which_nothing_follows_is_refused() -> None:
    said = between_two_bearings().model_dump(mode="json", exclude_none=True)
    said["bearings"][0]["elevation"] = {"y": 1e-5}
    with pytest.raises(DocumentError, match="leave it out"):
        parse_machine(said)
