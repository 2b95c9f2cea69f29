"""The model of a train's films against equilibria one by one, its derivatives against differences."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.arrays import Floats
from estimator.films.film import Film
from estimator.films.pad_table import THINNEST_FILM, THINNEST_KNOWN
from estimator.films.profiles import three_lobe
from estimator.machine.document import DocumentError, parse_machine
from estimator.statics.film_deviations import TERMS
from estimator.statics.film_model import FilmModel, film_model
from estimator.statics.solved_films import FilmTooThin
from tests.estimator.films.films import coarse_table
from tests.paths import EXAMPLES

SPEED = np.linspace(4600.0, 700.0, 60) * np.pi / 30


def document(**form: Any) -> dict[str, Any]:
    """The motor and compressor with bearings that follow their films."""
    said: dict[str, Any] = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal", "elevation_spread": 3e-5, **form}
    return said


def drawn(model: FilmModel, seed: int) -> Floats:
    """Fitted numbers drawn from the prior, closer to what is expected."""
    rng = np.random.default_rng(seed)
    own = np.array([one.centre + 0.4 * one.spread * rng.standard_normal() for one in model.parameters])
    # Of the stiffness of couplings and pedestals, which is read, priors are wide.
    return np.concatenate([0.2 * rng.standard_normal(len(model.read)), own])


def test_coefficients_are_those_of_the_equilibria_between_the_speeds_that_are_solved() -> None:
    model = film_model(parse_machine(document(discrepancy=0.0)))
    fitted = drawn(model, 1)
    found = model.at(SPEED).values(fitted).reshape(SPEED.size, 4, 8)
    for row, one in zip(found, model.own.changed(fitted).follow(SPEED), strict=True):
        assert one is not None
        exact = np.concatenate([one.stiffness.reshape(4, 4), one.damping.reshape(4, 4)], axis=1)
        for part in (slice(0, 4), slice(4, 8)):
            largest = np.abs(exact[:, part]).max(axis=1, keepdims=True)
            assert np.max(np.abs(row[:, part] - exact[:, part]) / largest) < 5e-4


def lobed_model(**more: Any) -> FilmModel:
    """The model of the same train in three-lobe bores, whose journals pass a lobe's centre of curvature."""
    model = film_model(parse_machine(document(discrepancy=0.0) | more))
    film = Film(three_lobe(preload=0.4), 0.5, table=coarse_table)
    lobed = {"profile": "three_lobe", "preload": 0.4}
    bearings = tuple(
        replace(one, film=film, described=one.described.model_copy(update=lobed)) for one in model.own.train.journals.values()
    )
    train = replace(model.own.train, bearings=bearings)
    return replace(model, own=replace(model.own, train=train), nominal=replace(model.nominal, train=train))


def test_coefficients_follow_a_film_that_turns_sharply_between_the_speeds_that_are_solved() -> None:
    model = lobed_model()
    fitted = drawn(model, 1)
    curves, exact = model.at(SPEED), model.films.equilibria_at(fitted, SPEED)
    assert exact is not None
    found = curves.values(fitted).reshape(SPEED.size, 4, 8)
    for order, name in enumerate(("stiffness", "damping")):
        due = np.array([[getattr(film, name).ravel() for film in one.film] for one in exact])
        error = np.abs(found[..., 4 * order : 4 * order + 4] - due).max(axis=2) / np.abs(due).max(axis=2)
        assert error.max() < 5e-4
    slopes, size = curves.derivatives(fitted, slice(0, 60, 5)), np.abs(found).reshape(SPEED.size, -1).max(axis=0)
    for place in range(0, fitted.size, 3):
        step = 1e-4 * np.eye(fitted.size)[place]
        difference = (curves.values(fitted + step) - curves.values(fitted - step))[::5] / 2e-4
        np.testing.assert_allclose(slopes[:, :, place] / size, difference / size, atol=2e-4)


def test_loads_and_warming_move_a_film_that_turns_sharply_as_differences_do() -> None:
    disc = document()["discs"][0]
    load = {"id": "gear", "shaft": disc["shaft"], "station": disc["station"], "force_y": -500.0}
    exact = lobed_model(static_loads=[load])
    free = lobed_model(static_loads=[load | {"force_x_spread": 800.0, "force_y_spread": 800.0}])
    names = [one.name for one in free.numbers]
    fitted = np.array([one.centre for one in free.numbers])
    curves, by_load = free.at(SPEED), exact.at(SPEED).by_load(np.array([one.centre for one in exact.numbers]))
    for component, axis in enumerate("xy"):
        step = np.zeros(fitted.size)
        step[names.index(f"static_load.gear.force_{axis}")] = 1e-4
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / 2e-4 / 800.0
        np.testing.assert_allclose(by_load[..., component], difference, atol=1e-3 * np.abs(difference).max())
    thicker = 1e-4 * np.array([one.quantity == "viscosity" for one in free.numbers])
    by_viscosity = (curves.values(fitted + thicker) - curves.values(fitted - thicker)) / 2e-4
    due = (np.log(free.nominal.speed).mean() - np.log(SPEED))[:, None] * by_viscosity
    np.testing.assert_allclose(curves.viscosity_trend(fitted), due, atol=1e-3 * np.abs(due).max())


@pytest.mark.parametrize("discrepancy", [0.0, 0.05])
def test_derivatives_are_those_of_differences(discrepancy: float) -> None:
    model = film_model(parse_machine(document(discrepancy=discrepancy)))
    curves, fitted = model.at(SPEED), drawn(model, 2)
    found = curves.derivatives(fitted, slice(None))
    assert found.shape == (SPEED.size, 32, len(model.numbers))
    size = np.abs(curves.values(fitted)).max(axis=0)
    for place in {*range(20), *range(20, len(model.numbers), 9), len(model.numbers) - 1}:
        step = np.zeros(fitted.size)
        step[place] = 1e-3
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / 2e-3
        np.testing.assert_allclose(found[:, :, place] / size, difference / size, atol=2e-4)


def test_films_of_one_supply_may_differ_from_it_by_a_ratio_each() -> None:
    said = document(discrepancy=0.0)
    for bearing in said["bearings"][:2]:
        bearing["film"]["oil"]["supply"] = "motor"
        bearing["speed_dependence"]["viscosity_ratio_spread"] = 0.03
    model = film_model(parse_machine(said))
    names = [one.name for one in model.numbers]
    ratio = "bearing.B1.viscosity_ratio"
    assert [name for name in names if "ratio" in name] == [ratio, "bearing.B2.viscosity_ratio"]
    curves, fitted = model.at(SPEED), drawn(model, 3)
    found = curves.derivatives(fitted, slice(None))
    both = found[:, :, names.index(ratio)] + found[:, :, names.index("bearing.B2.viscosity_ratio")]
    common = found[:, :, names.index("oil.motor.viscosity_factor")]
    np.testing.assert_allclose(both, common, atol=1e-9 * np.abs(common).max())
    said["bearings"][2]["speed_dependence"]["viscosity_ratio_spread"] = 0.03
    with pytest.raises(DocumentError, match=r"viscosity_ratio_spread: .*film.oil.supply must name it"):
        parse_machine(said)


def test_derivatives_of_warmed_oils_and_of_one_supply_are_those_of_differences() -> None:
    said = document(discrepancy=0.0, viscosity_slope_spread=0.2)
    for bearing in said["bearings"]:
        bearing["film"]["oil"] = {"iso_vg": 46, "inlet_c": 45.0}
    for bearing in said["bearings"][:2]:
        bearing["film"]["oil"]["supply"] = "motor"
    model = film_model(parse_machine(said))
    names = [one.name for one in model.numbers]
    shared = ["oil.motor.viscosity_factor", "oil.motor.viscosity_slope"]
    assert [name for name in names if "viscosity" in name] == [
        *shared, "bearing.B3.viscosity", "bearing.B3.viscosity_slope", "bearing.B4.viscosity", "bearing.B4.viscosity_slope",
    ]  # fmt: skip
    curves, fitted = model.at(SPEED), drawn(model, 2)
    found, size = curves.derivatives(fitted, slice(None)), np.abs(curves.values(fitted)).max(axis=0)
    for place in range(len(names)):
        step = np.zeros(fitted.size)
        step[place] = 1e-3
        difference = (curves.values(fitted + step) - curves.values(fitted - step)) / 2e-3
        np.testing.assert_allclose(found[:, :, place] / size, difference / size, atol=2e-4)
    thick = model.own.changed(np.where(np.array(names) == shared[0], 0.1, [one.centre for one in model.numbers]))
    for number, factor in enumerate((np.exp(0.1), np.exp(0.1), 1.0, 1.0)):
        assert thick.journals[number].oil.value == pytest.approx(factor * model.own.train.journals[number].oil.value)


@pytest.mark.parametrize("discrepancy", [0.0, 0.05])
def test_outputs_are_chained_to_the_numbers_as_by_all_derivatives(discrepancy: float) -> None:
    model = film_model(parse_machine(document(discrepancy=discrepancy)))
    curves, fitted, block = model.at(SPEED), drawn(model, 3), slice(5, 20)
    parts = np.random.default_rng(1).standard_normal((2, 32, 15, 3)) / np.abs(curves.values(fitted)[block]).T[:, :, None]
    by_coefficient = parts[0] + 1j * parts[1]
    expected = np.einsum("scp,csm->psm", curves.derivatives(fitted, block), by_coefficient)
    found = curves.chained(fitted, block, by_coefficient)
    nuisance = np.array([one.nuisance for one in model.numbers])
    step = curves.values(fitted) - curves.values(np.where(nuisance, 0.0, fitted))
    along = curves.derivatives(fitted, slice(None))[..., nuisance] @ fitted[nuisance]
    np.testing.assert_allclose(step, along, atol=1e-9 * np.abs(curves.values(fitted)).max())
    np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_the_trend_of_viscosity_is_that_of_differences_at_the_speeds_that_are_solved() -> None:
    model = film_model(parse_machine(document(discrepancy=0.0)))
    speed, fitted = model.nominal.speed, drawn(model, 6)
    found = model.at(speed).viscosity_trend(fitted)
    viscosity = np.array([one.quantity == "viscosity" for one in model.numbers])
    for place in (0, 5, 11):
        away, curves = np.log(speed[place]) - np.log(speed).mean(), model.at(speed[place : place + 1])
        rows = [curves.values(fitted - sign * 1e-4 * away * viscosity)[0] for sign in (1.0, -1.0)]
        difference = (rows[0] - rows[1]) / 2e-4
        np.testing.assert_allclose(found[place], difference, atol=1e-5 * np.abs(rows[0]).max())


def test_what_was_solved_before_changes_nothing() -> None:
    machine = parse_machine(document())
    first, second = film_model(machine), film_model(machine)
    for seed in range(4):
        first.at(SPEED).derivatives(drawn(first, seed), slice(None))
    fitted = drawn(second, 5)
    np.testing.assert_allclose(first.at(SPEED).values(fitted), second.at(SPEED).values(fitted), rtol=1e-7)


def test_the_documents_films_are_those_followed_speed_by_speed() -> None:
    nominal = film_model(parse_machine(document())).nominal
    for one, other in zip(nominal.equilibria, nominal.train.follow(nominal.speed), strict=True):
        assert other is not None
        np.testing.assert_allclose(one.position, other.position, atol=1e-12)


@pytest.mark.parametrize(
    ("term", "run_damping", "size"),
    [("kxx", 0.05, 0.05), ("cxx", 0.0, 0.05), ("cxx", 0.05, np.hypot(0.05, 0.05)), ("cxy", 0.05, 0.0387)],
)
def test_deviations_have_the_size_that_the_document_states(term: str, run_damping: float, size: float) -> None:
    said = document(discrepancy=0.05) | {"operation": {"healthy_variation": {"damping": run_damping}}}
    model = film_model(parse_machine(said))
    curves = model.at(SPEED)
    centre = np.array([one.centre for one in model.numbers])
    own, rng = curves.values(centre), np.random.default_rng(3)
    drawn = np.array([one.spread * one.nuisance for one in model.numbers])
    whole = own.reshape(SPEED.size, -1, 8)[:, 1]
    kind = term[0]
    over = np.sqrt(np.abs(np.prod([whole[:, TERMS.index(f"{kind}{2 * axis}")] for axis in (term[1], term[2])], axis=0)))
    column = 8 + TERMS.index(term)
    parts = [
        (curves.values(centre + drawn * rng.standard_normal(centre.size))[:, column] - own[:, column]) / over
        for _ in range(600)
    ]
    assert np.sqrt(np.mean(np.square(parts))) == pytest.approx(size, rel=0.1)


def test_a_film_that_is_too_thin_has_no_coefficients() -> None:
    model = film_model(parse_machine(document()))
    centre = np.array([one.centre for one in model.numbers])
    centre[model.own.place(0, "viscosity")] = -8.0  # hardly any viscosity
    assert np.isnan(model.at(SPEED).values(centre)).all()


def test_films_of_a_fit_may_be_thinner_than_the_documents() -> None:
    model = film_model(parse_machine(document(discrepancy=0.0)))
    assert np.min([thinnest(model, one.position) for one in model.nominal.equilibria]) >= THINNEST_FILM
    centre, found = np.array([one.centre for one in model.numbers]), 1.0
    place = model.own.place(0, "viscosity")
    for factor in np.linspace(0.0, 3.0, 61):
        fitted = centre.copy()
        fitted[place] -= factor
        films = model.films.equilibria(fitted)
        if films is None:
            break
        found = min(thinnest(model, one.position) for one in films)
    assert THINNEST_KNOWN <= found < THINNEST_KNOWN + 0.002


def thinnest(model: FilmModel, position: Floats) -> float:
    """The thinnest film of the journals at positions (n, 2) [m], in clearances of the document."""
    pairs = zip(model.nominal.train.journals.values(), position, strict=True)
    return min(one.thinnest(place) / one.clearance for one, place in pairs)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda said: said["bearings"][2].pop("film"), "needs the bearing's film"),
        (lambda said: said["couplings"][0].update(speed_dependence={"form": "journal"}), "of bearings with a film only"),
        (lambda said: said["bearings"][0]["speed_dependence"].update(elevation_spread=30.0), "elevation_spread"),
        (
            lambda said: [
                one["film"]["oil"].update(supply="main") or one["speed_dependence"].update(viscosity_spread=0.1 + 0.1 * k)
                for k, one in enumerate(said["bearings"][:2])
            ],
            "another one than that of the first bearing of supply 'main'",
        ),
        (
            lambda said: said.update(parameters=[{"names": "bearing.B1.kxx", "fixed": True}]),
            "films follow from form 'journal'",
        ),
    ],
)
def test_a_document_that_leaves_loads_open_is_refused(change: Any, words: str) -> None:
    said = document()
    change(said)
    with pytest.raises(DocumentError, match=words):
        parse_machine(said)


def test_a_film_that_never_carries_is_named_and_one_that_is_lifted_by_jacking_oil_is_left_out() -> None:
    said = document()
    said["speed_range"]["minimum_rpm"] = 5
    with pytest.raises(
        FilmTooThin,
        match=r"at 5 r/min.*on bearing 'B\d', whose journal touches first, at rest are 0\.\d+ MPa.*valid_above_rpm",
    ):
        _ = film_model(parse_machine(said)).films
    said["bearings"][2]["film"]["valid_above_rpm"] = 700
    films = film_model(parse_machine(said)).films
    assert films.nominal.speed[0] == pytest.approx(700 * np.pi / 30)


def test_beyond_the_range_coefficients_are_level() -> None:
    model = film_model(parse_machine(document()))
    centre = np.array([one.centre for one in model.numbers])
    ends = np.array([model.nominal.slowest, model.nominal.fastest])
    beyond = np.array([0.0, 2 * ends[1]])
    np.testing.assert_array_equal(model.at(beyond).values(centre), model.at(ends).values(centre))
