"""A train on oil films under watch, of runs that a linear model draws: what moved is named, in its own units."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from estimator.alignment.open_stiffness import OPEN
from estimator.arrays import Floats
from estimator.diagnosis.bayes_factors import Diagnosis, diagnose
from estimator.diagnosis.data_faults import fits, is_uninformative
from estimator.diagnosis.film_reference import film_observation, film_reference, is_of_films
from estimator.diagnosis.finding_kind import BaselineValues, Cause
from estimator.diagnosis.finding_kinds import finding_kind
from estimator.diagnosis.observation import Observation, ObservedFit
from estimator.diagnosis.run_windows import RunWindows
from estimator.fit.validation.channel_sensitivity import ChannelEffects
from estimator.machine.alignment_rules import HealthyVariation
from estimator.machine.document import Machine, parse_machine
from estimator.machine.under_conditions import under_conditions
from estimator.updated_model.model import UpdatedModel, expected_model
from tests.estimator.alignment.drawn_runs import COORDINATES, MODEL, drawn_machine, drawn_run, fitted, place
from tests.estimator.statics.films import motor_compressor_document

VARIATION = HealthyVariation()
CHANNELS = MODEL.machine.channels
BASELINE = 6


def effects(size: int) -> ChannelEffects:
    """Channels whose errors would not move the fit, and would be seen at once."""
    names = [f"probe.{c}.{what}.{part}" for c in CHANNELS for what in ("gain", "run_out") for part in ("real", "imaginary")]
    error = np.array([1e-2 if ".gain." in name else 1e-7 for name in names])
    return ChannelEffects(
        names=tuple(names),
        bias=np.zeros((size, len(names))),
        information=np.diag(error**-2.0),
        score=np.zeros(len(names)),
        phasors=(150,) * len(CHANNELS),
        amplitude=(5e-5,) * len(CHANNELS),
    )


def observed(model: UpdatedModel, **changes: Any) -> ObservedFit:
    said: dict[str, Any] = {
        "coordinates": model.coordinates,
        "point": model.values,
        "covariance": model.covariance,
        "effects": effects(len(model.coordinates)),
        "accepted": True,
        "chi_square": 2400.0,
        "degrees_of_freedom": 2400,
        "samples": 150,
        "outliers": {},
    }
    return ObservedFit(**(said | changes))


def says(model: UpdatedModel, **changes: Any) -> Observation:
    return film_observation(observed(model, **changes), MODEL.machine, {})


@cache
def machine() -> Floats:
    return drawn_machine(np.random.default_rng(3))


@cache
def watch() -> RunWindows:
    rng = np.random.default_rng(4)
    runs = [fitted(drawn_run(machine(), VARIATION, rng), rng) for _ in range(BASELINE)]
    return RunWindows.from_baseline(MODEL.machine, [says(one) for one in runs], variation=VARIATION)


def after(changes: Mapping[str, float], *, runs: int = 2, seed: int = 5, **fit: Any) -> list[Observation]:
    """Runs of the machine with some coordinates changed, in SI or as logarithms."""
    rng = np.random.default_rng(seed)
    moved = machine().copy()
    for name, by in changes.items():
        moved[place(name)] += by / COORDINATES.unit[place(name)]
    return [says(fitted(drawn_run(moved, VARIATION, rng), rng), **fit) for _ in range(runs)]


def found(observations: list[Observation]) -> Diagnosis:
    return watch().found(observations, on_delay=lambda _kind, _element: 2)


def only(observations: list[Observation]) -> Cause:
    (cause,) = found(observations).causes
    return cause


def test_nothing_is_found_while_nothing_has_happened() -> None:
    assert found(after({}, runs=6)).causes == ()


def test_a_shaft_that_sinks_is_a_misalignment_of_its_coupling() -> None:
    cause = only(after({"bearing.B3.elevation_y": -80e-6, "bearing.B4.elevation_y": -80e-6}))
    assert (cause.kind, cause.element) == ("misalignment", "coupling.C1")
    moved = dict(zip(cause.names, cause.change, strict=True))
    assert moved["bearing.B3.elevation_y"] == pytest.approx(-80e-6, rel=0.3)


@pytest.mark.parametrize("thicker", [0.45, -0.45])
def test_ten_kelvin_of_oil_are_nothing(thicker: float) -> None:
    assert found(after({f"bearing.B{number}.viscosity": thicker for number in range(1, 5)}, runs=6)).causes == ()


def test_another_oil_is_named() -> None:
    cause = only(after({f"bearing.B{number}.viscosity": 1.5 for number in range(1, 5)}))
    assert (cause.kind, cause.element) == ("oil", "machine")


@pytest.mark.parametrize("bearing", ["B1", "B3"])
def test_a_clearance_that_grows_is_wear(bearing: str) -> None:
    cause = only(after({f"bearing.{bearing}.clearance": 0.14}))
    assert (cause.kind, cause.element) == ("wear", f"bearing.{bearing}")
    values = BaselineValues(dict(zip(watch().reference.names, watch().reference.mean, strict=True)), {})
    size = finding_kind("wear").size
    assert size is not None
    assert size(cause, values).per_cent == pytest.approx(15.0, abs=5.0)


def test_a_clearance_that_shrinks_is_no_wear() -> None:
    assert all(cause.kind != "wear" for cause in found(after({"bearing.B1.clearance": -0.14})).causes)


def test_a_coupling_that_softens_is_a_coupling() -> None:
    cause = only(after({f"coupling.C1.{term}": -0.3 for term in ("kxx", "kyy", "k_phix", "k_phiy")}))
    assert (cause.kind, cause.element) == ("coupling", "coupling.C1")


def test_a_film_that_deviates_otherwise_is_a_bearing() -> None:
    shapes = [name for name in COORDINATES.names if name.startswith(("films.B2.kyy_", "films.B2.cyy_", "films.B2.kxy_"))]
    cause = only(after({name: 2.0 * (-1) ** number for number, name in enumerate(shapes)}))
    assert (cause.kind, cause.element) == ("bearing", "bearing.B2")


def test_a_run_that_is_refused_for_its_films_alone_says_what_it_says() -> None:
    """Its χ² is good: the films explain it, with deviations that are larger than the document says."""
    moved = {"bearing.B3.elevation_y": -80e-6, "bearing.B4.elevation_y": -80e-6}
    assert only(after(moved, accepted=False)).kind == "misalignment"
    assert only(after(moved, accepted=False, chi_square=9000.0)).kind == "misfit"


def test_a_refused_run_whose_films_deviate_absurdly_says_nothing() -> None:
    one, *_ = after({}, runs=1, accepted=False)
    assert not is_uninformative(one)
    deviating = [name.startswith("films.B2.") for name in one.names]
    absurd = replace(one, reference=np.where(deviating, 4.0, one.reference))
    assert is_uninformative(absurd)
    assert not fits(absurd, frozenset())
    assert not is_uninformative(replace(absurd, accepted=True))


def test_what_was_believed_beforehand_is_not_counted_with_every_run() -> None:
    """Runs that see nothing leave the machine where it is believed to be, however many they are."""
    blind = structs.replace(MODEL, covariance=np.diag((COORDINATES.spread * COORDINATES.unit) ** 2))
    reference = film_reference(MODEL.machine, [says(blind)] * 9, VARIATION)
    known = [reference.names.index(name) for name in ("bearing.B1.clearance", "bearing.B1.elevation_y")]
    error = np.sqrt(np.diag(reference.doubt)[known]) * reference.unit[known]
    assert error == pytest.approx([np.hypot(0.15, 0.01), np.hypot(150e-6, 2e-6)], rel=0.02)


def with_temperature() -> Machine:
    said: dict[str, Any] = motor_compressor_document("flexible", "aligned")
    said["conditions"] = [{"name": "oil", "unit": "degC"}]
    for bearing in said["bearings"]:
        bearing["speed_dependence"] = {"form": "journal"}
        bearing["film"]["oil"] = {"iso_vg": 46, "temperature_c": 50.0, "temperature_from": "oil"}
    return parse_machine(said)


def test_viscosities_count_from_those_of_each_runs_own_temperature() -> None:
    train = with_temperature()
    cold = expected_model(under_conditions(train, {"oil": 40.0}))
    assert cold.values[place("bearing.B1.viscosity")] > expected_model(train).values[place("bearing.B1.viscosity")] + 0.3
    fit = observed(structs.replace(cold, covariance=np.diag((COORDINATES.spread * COORDINATES.unit) ** 2)))
    said = film_observation(fit, train, {"oil": 40.0})
    assert said.reference[said.names.index("bearing.B1.viscosity")] == pytest.approx(
        expected_model(train).values[place("bearing.B1.viscosity")]
    )


def test_a_fit_that_lacks_coordinates_is_of_another_train() -> None:
    one = fitted(machine(), np.random.default_rng(0))
    assert is_of_films(observed(one), MODEL.machine)
    assert not is_of_films(observed(one, coordinates=one.coordinates[1:]), MODEL.machine)


def test_observations_of_other_quantities_make_no_baseline() -> None:
    with pytest.raises(ValueError, match="at least one identification"):
        film_reference(MODEL.machine, [], VARIATION)
    one = says(fitted(machine(), np.random.default_rng(0)))
    with pytest.raises(ValueError, match="of different quantities"):
        film_reference(MODEL.machine, [one, replace(one, names=(*one.names[:-1], "other.X.kxx"))], VARIATION)


STIFFNESSES = [f"coupling.C1.{term}" for term in ("kxx", "kyy", "k_phix", "k_phiy")]


def hardly_seeing_the_coupling(one: Observation, *, softer: float = 0.0) -> Observation:
    """A run that says little of the coupling's stiffness, which its fit found softer (logarithm): it counts by compliance."""
    places = [one.names.index(name) for name in STIFFNESSES]
    seen = np.ones(len(one.names))
    seen[places] = 0.05
    linear = replace(one, information=one.information * np.outer(seen, seen), gradient=seen * one.gradient)
    # To compliances at another place, of which the logarithm is reckoned with: the change of variables the other way round.
    slope, found = np.ones(len(one.names)), linear.reference.copy()
    if softer:
        away = 1.0 - softer  # a logarithm within one of the usual stays
        found[places] -= softer
        slope[places] = np.exp(-away)
        at = linear.reference.copy()
        at[places] += -np.exp(-away)
        linear = replace(linear, gradient=linear.gradient + linear.information @ (linear.reference - at))
    information = linear.information * np.outer(slope, slope)
    return replace(linear, reference=found, gradient=slope * linear.gradient, information=information)


def test_a_fit_that_finds_a_stiff_coupling_soft_says_what_others_say() -> None:
    rng = np.random.default_rng(11)
    runs = [hardly_seeing_the_coupling(says(fitted(drawn_run(machine(), VARIATION, rng), rng))) for _ in range(BASELINE)]
    reference = film_reference(MODEL.machine, runs, VARIATION)
    assert set(reference.left_open) == set(STIFFNESSES)
    assert min(reference.left_open.values()) > OPEN
    sunk = after({"bearing.B3.elevation_y": -80e-6, "bearing.B4.elevation_y": -80e-6})
    usual, soft = (
        diagnose(reference, [hardly_seeing_the_coupling(one, softer=softer) for one in sunk]) for softer in (0.0, 3.0)
    )
    assert [one.kind for one in soft.causes] == ["misalignment"]
    assert soft.causes[0].evidence == pytest.approx(usual.causes[0].evidence, abs=0.5)
    assert soft.causes[0].change == pytest.approx(usual.causes[0].change, abs=1e-6)
    held = diagnose(replace(reference, carried=None), [hardly_seeing_the_coupling(one, softer=3.0) for one in sunk])
    assert held.causes[0].evidence < usual.causes[0].evidence - 5.0


def test_a_channel_that_was_dead_in_a_run_of_the_baseline_hides_no_coupling_that_is_left_open() -> None:
    rng = np.random.default_rng(11)
    runs = [hardly_seeing_the_coupling(says(fitted(drawn_run(machine(), VARIATION, rng), rng))) for _ in range(BASELINE)]
    known = np.array([not name.startswith(f"probe.{CHANNELS[0]}.") for name in runs[0].names])
    dead = replace(runs[0], information=runs[0].information * np.outer(known, known), gradient=known * runs[0].gradient)
    whole = film_reference(MODEL.machine, runs, VARIATION)
    found = film_reference(MODEL.machine, [dead, *runs[1:]], VARIATION)
    assert set(found.left_open) == set(STIFFNESSES)
    assert found.left_open == pytest.approx(whole.left_open, rel=0.1)
