"""Bow, equivalent loads of a coupling, run-out and gain of a channel: simulated by full solves, then identified."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement, joined
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from tests.estimator.full_train import (
    Force,
    coupling_nodes,
    deviations,
    full_response,
    node_of,
    true_values,
    unbalance_force,
)
from tests.estimator.trains import Complexes, Floats, chapter_3, chapter_3_document, noisy

SPEED: Floats = np.arange(10.0, 300.0, 3.0)
BOW = {"shaft.S1.bow": 2e-3 * np.exp(0.4j), "shaft.S2.bow": 1.2e-3 * np.exp(-2.0j)}
LOAD = {
    "coupling.C1.force_x": 60.0 + 20j,
    "coupling.C1.force_y": -35.0 + 40j,
    "coupling.C1.moment_x": 8.0 - 3j,
    "coupling.C1.moment_y": 2.0 + 6j,
}
ROTATING = {"coupling.C1.rotating_offset": 4e-5 * np.exp(0.3j), "coupling.C1.rotating_angle": 6e-4 * np.exp(-1.2j)}
RUN_OUT = {"probe.B1X.run_out": 2e-4 * np.exp(1j), "probe.B3Y.run_out": 3e-4 * np.exp(-1.5j)}
GAIN = {"probe.B2X.gain": 1.05 * np.exp(0.04j), "probe.B4Y.gain": 0.96 * np.exp(-0.03j)}


def with_bow() -> Machine:
    document = chapter_3_document()
    for shaft in document["shafts"]:
        shaft["bow_spread"] = 2e-3
    return parse_machine(document)


def with_load() -> Machine:
    document = chapter_3_document()
    document["couplings"][0]["load"] = {"force_spread": 50.0, "moment_spread": 5.0}
    return parse_machine(document)


def with_probes(**changes: float) -> Machine:
    document = chapter_3_document()
    for probe in document["probes"]:
        probe.update(changes)
    return parse_machine(document)


def bow_force(machine: Machine) -> Force:
    """K_shaft times a half sine over each shaft's length, turning with the shaft: along y a quarter turn behind x.

    The slopes are the half sine's derivatives: θy = dx/dz, θx = -dy/dz.
    """
    rotor = assemble_rotor(machine)
    bent = np.zeros(rotor.size, dtype=complex)
    for shaft in machine.shafts:
        bow = BOW[f"shaft.{shaft.id}.bow"]
        for station in rotor.stations[shaft.id]:
            x = node_of(machine, shaft.id, station)
            height = math.sin(math.pi * station / shaft.length)
            slope = math.pi / shaft.length * math.cos(math.pi * station / shaft.length)
            bent[x : x + 4] = bow * np.array([height, -1j * height, 1j * slope, slope])
    added = rotor.stiffness @ bent
    return lambda speed: np.asarray(unbalance_force(machine)(speed) + added)


def load_force(machine: Machine) -> Force:
    """The same forces and moments on both halves of the coupling, opposite in sign, at every speed."""
    added = np.zeros(assemble_rotor(machine).size, dtype=complex)
    for x, sign in zip(coupling_nodes(machine, machine.couplings[0]), (1, -1), strict=True):
        added[x : x + 4] = sign * np.array(list(LOAD.values()))
    return lambda speed: np.asarray(unbalance_force(machine)(speed) + added)


def with_run_out_of_coupling() -> Machine:
    document = chapter_3_document()
    document["couplings"][0]["rotating_error"] = {"offset_spread": 5e-5, "angle_spread": 5e-4}
    return parse_machine(document)


def pull_of_run_out(machine: Machine) -> Force:
    """A coupling that is free of load where its ends stand apart: along y a quarter turn behind x, θy = dx/dz, θx = -dy/dz.

    It pulls with its own stiffness towards that place.
    """
    offset, angle = ROTATING.values()
    coupling = machine.couplings[0]
    lateral = np.array([[coupling.kxx, coupling.kxy], [coupling.kyx, coupling.kyy]], dtype=float) @ [offset, -1j * offset]
    angular = np.array([coupling.k_phix, coupling.k_phiy], dtype=float) * [1j * angle, angle]
    pull = np.concatenate([lateral, angular])
    added = np.zeros(assemble_rotor(machine).size, dtype=complex)
    for x, sign in zip(coupling_nodes(machine, coupling), (-1, 1), strict=True):
        added[x : x + 4] = sign * pull
    return lambda speed: np.asarray(unbalance_force(machine)(speed) + added)


def seen(machine: Machine, phasor: Complexes, direction: int, channels: dict[str, complex]) -> Complexes:
    """Phasors through the channels' gains, with their run-out, which the surface under the probe shows mirrored in reverse."""
    shown = phasor.copy()
    for k, channel in enumerate(machine.channels):
        shown[:, k] *= channels.get(f"probe.{channel}.gain", 1.0)
        run_out = complex(channels.get(f"probe.{channel}.run_out", 0.0))
        shown[:, k] += run_out if direction > 0 else run_out.conjugate()
    return shown


def measured(machine: Machine, force: Force, direction: int, seed: int = 7) -> Measurement:
    phasor = full_response(machine, SPEED, direction=direction, force=force)
    return Measurement.of(speed=SPEED, phasor=noisy(phasor, seed=seed), direction=direction)


def assert_refused(measurement: Measurement) -> None:
    """A model that has bearings, coupling and unbalances only cannot follow; a third of the samples says so."""
    third = np.arange(measurement.speed.size) % 3 == 0
    found = identify(chapter_3(), measurement.pick(third), Options(starts=1))
    assert not found.accepted
    assert found.verdict.startswith(("the model does not fit the data", "too much does not fit", "not converged"))


def assert_found(found: Identification, expected: dict[str, complex]) -> None:
    """Accepted, and both what is expected and the train's own parameters are found."""
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) < 5 * math.sqrt(2 / found.degrees_of_freedom)
    for name in expected:
        assert found.estimate(name).estimable
    assert np.abs(deviations(found, expected)).max() < 4.0
    assert np.abs(deviations(found, true_values(chapter_3()))).max() < 4.5


TURNING: Mapping[str, tuple[Callable[[], Machine], Callable[[Machine], Force], Mapping[str, complex]]] = {
    "bow": (with_bow, bow_force, BOW),
    "load": (with_load, load_force, LOAD),
    "run-out of the coupling": (with_run_out_of_coupling, pull_of_run_out, ROTATING),
}
"""Excitations that turn beside the unbalances: machine, force and values."""


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("what", TURNING)
def test_response_to_what_turns_beside_the_unbalances(what: str, direction: int) -> None:
    described, force, values = TURNING[what]
    machine = described()
    train = condense(machine, speed=SPEED, direction=np.full(SPEED.size, float(direction)))
    coefficients = np.array([c.nominal for c in train.unknowns.coefficients], dtype=float)
    assert [one.name for one in train.unknowns.excitations[4:]] == list(values)
    excitations = np.array([one.nominal for one in train.unknowns.unbalances] + list(values.values()), dtype=complex)
    found = response(train, coefficients=coefficients, excitations=excitations)
    expected = full_response(machine, SPEED, direction=direction, force=force(machine))
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("what", ["bow", "load"])
def test_it_is_identified(what: str, direction: int) -> None:
    described, force, values = TURNING[what]
    machine = described()
    measurement = measured(machine, force(machine), direction)
    assert_found(identify(machine, measurement), dict(values))
    if direction > 0:
        assert_refused(measurement)


def test_slow_roll_of_a_bowed_shaft_in_stiff_bearings_is_its_bow() -> None:
    # Far below resonance the shaft shows its bow, less what the bearings' supports straighten: between the ends, rigidly held.
    document = chapter_3_document()
    document["couplings"] = []
    document["shafts"], document["discs"] = document["shafts"][:1], document["discs"][:1]
    document["bearings"] = document["bearings"][:2]
    for bearing, station in zip(document["bearings"], (0.0, 1.25), strict=True):
        bearing.update(station=station, kxx=1e12, kyy=1e12, kxy=0.0, kyx=0.0)
    document["shafts"][0]["bow_spread"] = 1e-4
    document["probes"] = [{"id": f"P{angle}", "shaft": "S1", "station": 0.625, "angle_deg": angle} for angle in (0, 45, 90)]
    machine = parse_machine(document)
    train = condense(machine, speed=np.array([0.1]), direction=np.ones(1))
    coefficients = np.array([c.nominal for c in train.unknowns.coefficients], dtype=float)
    bow = 1e-4 * np.exp(0.5j)
    found = response(train, coefficients=coefficients, excitations=np.array([0j, bow]))
    assert np.abs(found[0] / (bow * np.exp(-1j * np.radians([0, 45, 90]))) - 1).max() < 1e-4


def test_run_out_of_a_coupling_is_identified() -> None:
    machine = with_run_out_of_coupling()
    assert_found(identify(machine, measured(machine, pull_of_run_out(machine), 1)), dict(ROTATING))


def test_what_a_fit_leaves_out_of_a_coupling_is_what_one_that_asks_for_it_finds() -> None:
    """Of a small run-out, to first order."""
    machine = with_run_out_of_coupling()
    whole, own = pull_of_run_out(machine), unbalance_force(machine)
    part = 0.05
    measurement = measured(machine, lambda speed: own(speed) + part * (whole(speed) - own(speed)), 1)
    effects = identify(chapter_3(), measurement).channel_effects
    assert effects is not None
    places = [effects.names.index(f"{name}.{one}") for name in ROTATING for one in ("real", "imaginary")]
    information = effects.information[np.ix_(places, places)]
    told = np.linalg.solve(information, effects.score[places])
    exact = part * np.array([half for value in ROTATING.values() for half in (value.real, value.imag)])
    error = np.sqrt(np.diag(np.linalg.inv(information)))
    assert np.abs((told - exact) / error).max() < 4.0
    asked = identify(machine, measurement)
    for place, name in enumerate(ROTATING):
        one = asked.estimate(name)
        assert one.value is not None
        assert np.abs(one.value - told[2 * place]) < 1.5 * error[2 * place]


def test_load_from_both_senses_of_rotation() -> None:
    machine = with_load()
    runs = [measured(machine, load_force(machine), direction, seed=direction + 5) for direction in (1, -1)]
    assert_found(identify(machine, joined(runs)), dict(LOAD))


@pytest.mark.parametrize("directions", [(1,), (-1,), (1, -1)], ids=["forward", "backward", "both"])
@pytest.mark.parametrize(
    ("values", "changes"),
    [(RUN_OUT, {"run_out_spread": 3e-4}), (GAIN, {"gain_spread": 0.05})],
    ids=["run-out", "gain"],
)
def test_channels_are_identified(values: dict[str, complex], changes: dict[str, float], directions: tuple[int, ...]) -> None:
    machine = with_probes(**changes)
    runs = [
        Measurement.of(
            speed=SPEED,
            phasor=noisy(seen(machine, full_response(chapter_3(), SPEED, direction=d), d, values), seed=d + 3),
            direction=d,
        )
        for d in directions
    ]
    found = identify(machine, joined(runs))
    what = next(iter(values)).rsplit(".", 1)[-1]
    assert len([one for one in found.estimates if one.name.endswith(what)]) == 8
    assert_found(found, dict(values))
    exact = {f"probe.{c}.{what}": 1.0 if what == "gain" else 0.0 for c in machine.channels}
    assert np.abs(deviations(found, {**exact, **values})).max() < 4.0
    if len(directions) == 1:
        assert_refused(runs[0])


def test_all_at_once() -> None:
    document = chapter_3_document()
    document["couplings"][0]["load"] = {"force_spread": 50.0, "moment_spread": 5.0}
    for shaft in document["shafts"]:
        shaft["bow_spread"] = 2e-3
    for probe in document["probes"]:
        probe.update(gain_spread=0.05, run_out_spread=3e-4)
    document["materials"]["steel"].update(young_modulus_spread=0.05, density_spread=0.05)
    machine = parse_machine(document)
    own, bow, load = unbalance_force(machine), bow_force(machine), load_force(machine)
    runs = []
    for direction in (1, -1):
        clean = full_response(machine, SPEED, direction=direction, force=lambda w: bow(w) + load(w) - own(w))
        shown = noisy(seen(machine, clean, direction, {**RUN_OUT, **GAIN}), seed=direction + 1)
        runs.append(Measurement.of(speed=SPEED, phasor=shown, direction=direction))
    found = identify(machine, joined(runs))
    everything: dict[str, Any] = {**BOW, **LOAD, **RUN_OUT, **GAIN, "material.steel.density": 1.0}
    assert_found(found, everything)
