"""Statics with couplings and pedestals of any stiffness: against documents that say so; derivatives against differences."""

from typing import Any

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.fit.problem.coordinates import Coordinates
from estimator.fit.problem.linear_phasors import linear_phasors
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.statics.coupled_train import coupled_train, train_statics
from estimator.statics.film_model import film_model
from estimator.statics.shaft_centreline import ShaftCentreline, probe_views
from estimator.updated_model.bearing_loads import WEIGHT_ERROR
from estimator.updated_model.film_results import film_results
from estimator.updated_model.model import expected_model, model_at
from tests.estimator.statics.test_film_model import SPEED, document, drawn

LATERAL = {"kxx": 3e8, "kyy": 6e8, "cxx": 4e4, "cyy": 6e4, "mxx": 300.0, "myy": 300.0}


def said(*, rules: list[dict[str, Any]] | None = None, **form: Any) -> dict[str, Any]:
    """The motor and compressor with a stiff coupling, a force on its motor, two soft pedestals and a probe amid the shaft."""
    found = document(discrepancy=0.0, **form)
    found["couplings"][0] |= {"kxx": 2e8, "kyy": 3e8, "k_phix": 4e6, "k_phiy": 6e6}
    found["static_loads"] = [{"id": "gear", "shaft": "S1", "station": 0.68, "force_y": -400.0, "force_y_spread": 200.0}]
    found["pedestals"] = [{"id": f"P{number}", "bearing": f"B{number}", **LATERAL} for number in (2, 3)]
    found["probes"].append({"id": "middle", "shaft": "S1", "station": 1.2, "angle_deg": 60})
    return found | {"parameters": rules or []}


def factors_of(machine: Machine, seed: int = 0) -> Floats:
    count = len(coupled_train(machine).parameters)
    return np.exp(0.6 * np.random.default_rng(seed).standard_normal(count))


def scaled(found: dict[str, Any], names: tuple[str, ...], factors: Floats) -> Machine:
    """The document with stiffnesses that are some factors larger."""
    for name, factor in zip(names, factors.tolist(), strict=True):
        kind, part, term = name.split(".")
        next(one for one in found[f"{kind}s"] if one["id"] == part)[term] *= factor
    return parse_machine(found)


def names_of(machine: Machine) -> tuple[str, ...]:
    return tuple(one.name for one in coupled_train(machine).parameters)


def test_other_stiffness_acts_as_in_a_document_that_says_so() -> None:
    machine = parse_machine(said())
    assert len(names_of(machine)) == 8
    factors = factors_of(machine)
    found, due = coupled_train(machine).at(factors), train_statics(scaled(said(), names_of(machine), factors))
    for what in ("stiffness", "weight", "by_load"):
        one, other = getattr(found, what), getattr(due, what)
        np.testing.assert_allclose(one, other, atol=1e-8 * np.abs(other).max())
    usual = train_statics(machine)
    assert np.abs(found.weight - usual.weight).max() > 1e-3 * np.abs(usual.weight).max()


def test_slopes_are_those_of_differences() -> None:
    machine = parse_machine(said())
    train, factors = coupled_train(machine), factors_of(machine, 1)
    slopes = train.at(factors).slopes
    rows = probe_views(machine).rows
    for number in range(factors.size):
        step = np.exp(1e-5 * (np.arange(factors.size) == number))
        ahead, behind = train.at(factors * step), train.at(factors / step)
        for what in ("stiffness", "weight", "by_load"):
            difference = (getattr(ahead, what) - getattr(behind, what)) / 2e-5
            size = np.abs(getattr(ahead, what)).max()
            np.testing.assert_allclose(getattr(slopes, what)[number], difference, atol=1e-8 * size)
        difference = (train.motion(rows, factors * step)[0] - train.motion(rows, factors / step)[0]) / 2e-5
        np.testing.assert_allclose(train.motion(rows, factors)[1][number], difference, atol=1e-8)


def test_films_and_centreline_follow_the_stiffness_with_derivatives_as_differences() -> None:
    machine = parse_machine(said())
    model = film_model(machine)
    curves, fitted = model.at(SPEED), drawn(model, 2)
    line = ShaftCentreline(model.films, probe_views(machine), SPEED)
    for function, slopes in (
        (curves.values, curves.derivatives(fitted, slice(None))),
        (line.values, line.derivatives(fitted)),
    ):
        size = np.abs(function(fitted)).max(axis=0)
        for place in range(len(model.read)):
            step = 1e-4 * (np.arange(fitted.size) == place)
            difference = (function(fitted + step) - function(fitted - step)) / 2e-4
            np.testing.assert_allclose(slopes[:, :, place] / size, difference / size, atol=1e-4)
            assert np.abs(difference / size).max() > 1e-4, model.read[place]


def test_phasors_follow_the_stiffness_by_way_of_the_loads_too() -> None:
    """Derivatives of phasors by all coordinates that films read against differences."""
    machine = parse_machine(said())
    train = condense(machine, speed=SPEED[::6], direction=np.ones(SPEED[::6].size))
    coordinates = Coordinates.of(train, unbalance_scale=1e-3)
    model = expected_model(machine)
    theta = coordinates.theta(model.values)
    read = [place for one in coordinates.models for place in one.read]
    assert len(read) == 8

    def phasors(at: Floats) -> Floats:
        found = response(train, coefficients=coordinates.coefficients(at), excitations=coordinates.excitations(at))
        return np.asarray(found.view(float))

    found = linear_phasors(
        train, coordinates, theta, excitations=coordinates.excitations(theta), direction=np.ones(10), block=slice(0, 10)
    )
    size = np.abs(phasors(theta)).max()
    for place in read:
        step = 1e-4 * (np.arange(theta.size) == place)
        difference = (phasors(theta + step) - phasors(theta - step)) / 2e-4
        own = np.ascontiguousarray(found.jacobian[place]).view(float)
        np.testing.assert_allclose(own, difference, atol=1e-5 * size)


def test_stiffness_that_is_fixed_or_follows_another_is_not_read_twice() -> None:
    rules: list[dict[str, Any]] = [
        {"names": "coupling.C1.*", "fixed": True},
        {"names": "pedestal.P2.*", "spread": 0.2},
        {"names": "pedestal.P3.*", "tied_to": "pedestal.P2"},
    ]
    machine = parse_machine(said(rules=rules))
    assert names_of(machine) == ("pedestal.P2.kxx", "pedestal.P2.kyy")
    factors = np.array([0.5, 0.4])
    both = ("pedestal.P2.kxx", "pedestal.P2.kyy", "pedestal.P3.kxx", "pedestal.P3.kyy")
    due = train_statics(scaled(said(rules=rules), both, np.tile(factors, 2)))
    found = coupled_train(machine).at(factors)
    np.testing.assert_allclose(found.stiffness, due.stiffness, atol=1e-8 * np.abs(due.stiffness).max())


def test_a_load_is_as_uncertain_as_the_stiffness_that_it_follows_from() -> None:
    machine = parse_machine(said())
    model = expected_model(machine)
    place = list(model.coordinates).index("coupling.C1.kyy")
    covariance = np.zeros((model.values.size, model.values.size))
    covariance[place, place] = 0.1**2
    told = {one.name: one for one in film_results(model_at(machine, model.coordinates, model.values, covariance))}
    stiffer = model.values + 1e-3 * (np.arange(model.values.size) == place)
    moved = {one.name: one.value for one in film_results(model_at(machine, model.coordinates, stiffer, covariance))}
    load = told["bearing.B2.load_vertical"]
    of_coupling = 0.1 * abs(moved["bearing.B2.load_vertical"] - load.value) / 1e-3
    masses = WEIGHT_ERROR * np.hypot(load.value, told["bearing.B2.load_horizontal"].value)
    assert np.sqrt(load.error**2 - masses**2) == pytest.approx(of_coupling, rel=1e-2)
    assert of_coupling > 0.5


def test_a_shaft_on_one_bearing_hangs_in_its_coupling() -> None:
    """Three bearings in a line and a rigid coupling: loads are those of one shaft of all sections."""
    three = said()
    del three["pedestals"], three["static_loads"]
    three["probes"] = three["probes"][:4]
    three["couplings"][0] |= {"kxx": 1e12, "kyy": 1e12, "k_phix": 1e11, "k_phiy": 1e11}
    three["bearings"] = [one for one in three["bearings"] if one["id"] != "B3"]
    first, second = three["shafts"]
    length = sum(one["length"] for one in first["sections"])
    whole = three | {"couplings": [], "shafts": [{"id": "S1", "sections": [*first["sections"], *second["sections"]]}]}
    for part in ("bearings", "discs"):
        whole[part] = [
            one if one["shaft"] == "S1" else one | {"shaft": "S1", "station": one["station"] + length} for one in three[part]
        ]
    half = {"shaft": "S1", "station": length, "mass": 11.0, "diametral_inertia": 0.024, "polar_inertia": 0.04}
    whole["discs"] = [*whole["discs"], {"id": "halves", **half}]
    found, due = train_statics(parse_machine(three)), train_statics(parse_machine(whole))
    np.testing.assert_allclose(found.aligned, 0.0, atol=1e-12)
    np.testing.assert_allclose(found.weight, due.weight, rtol=1e-4, atol=1e-2)
    np.testing.assert_allclose(found.stiffness, due.stiffness, atol=1e-3 * np.abs(due.stiffness).max())
