"""Orbits at the probes with their errors, and the swapped channels and wrong senses of rotation that they show."""

from functools import cache
from typing import Any

import numpy as np
import pytest
import yaml

from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.orbits import ExpectedOrbits, OrbitFinding, orbit_findings, station_orbits
from estimator.phasors.probe_axes import probe_stations
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from tests.estimator.trains import ROOT, Complexes, Document, Floats, chapter_3, chapter_3_document, one_disc_document

TRAINS = ("motor-pump", "thesis-chapter-3", "thesis-chapter-5-rig", "turbine-compressor-generator")
BLIND = {"sealed-pump": [("C2L", "C2R")]}
"""Stations at which the model's own orbit may turn either way: beside a node of the static deflection."""


def example(name: str, **changes: Any) -> Machine:
    document = yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text(encoding="utf-8"))
    return parse_machine({**document, **changes})


@cache
def run(name: str, *, turning: str = "positive", seed: int = 1) -> Measurement:
    """A noisy run-down of a machine near its document with 10 µm of run-out, declared to turn from +x to +y."""
    machine = example(name, rotation=turning)
    rng = np.random.default_rng(seed)
    _, speed = speed_law(machine, "run-down", duration=600.0, samples=200)
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
    run_out = 1e-5 * np.exp(2j * np.pi * rng.random(phasor.shape[1]))
    return Measurement.of(speed=speed, phasor=phasor + run_out)


def swapped(measurement: Measurement, *pairs: tuple[int, ...]) -> Measurement:
    phasor = measurement.phasor.copy()
    for first, second in pairs:
        phasor[:, [first, second]] = phasor[:, [second, first]]
    return Measurement.of(speed=measurement.speed, phasor=phasor)


def wrong(findings: tuple[OrbitFinding, ...]) -> list[tuple[str, tuple[str, ...]]]:
    return [(one.code, one.channels) for one in findings if one.code != "orbit_sense_undetectable"]


@pytest.mark.parametrize("name", [*TRAINS, *BLIND])
def test_each_swapped_pair_of_each_example_is_found_and_nothing_else(name: str) -> None:
    machine, right = example(name), run(name)
    blind = BLIND.get(name, [])
    clean = orbit_findings(machine, right)
    assert wrong(clean) == []
    assert [one.channels for one in clean] == blind
    for place in probe_stations(machine):
        found = orbit_findings(machine, swapped(right, place.columns))
        assert wrong(found) == ([] if place.channels in blind else [("swapped_channels", place.channels)])


@pytest.mark.parametrize("name", TRAINS)
def test_a_wrong_sense_of_rotation_is_found(name: str) -> None:
    machine = example(name)
    (one,) = orbit_findings(machine, run(name, turning="negative"))
    assert (one.code, one.channels) == ("wrong_rotation", machine.channels)
    declared = example(name, rotation="negative")
    right = run(name, turning="negative")
    assert orbit_findings(declared, Measurement.of(speed=right.speed, phasor=right.phasor, direction=-1.0)) == ()


def test_half_of_the_pairs_backward_may_mean_either() -> None:
    found = orbit_findings(example("motor-pump"), swapped(run("motor-pump"), (0, 1), (4, 5)))
    assert [one.code for one in found] == ["swapped_or_wrong_rotation"] * 2
    assert "2 of 4 pairs" in found[0].words


def one_disc(*, probes: list[dict[str, Any]] | None = None, **changes: Any) -> Machine:
    document: Document = one_disc_document(kyy=3e6)
    document["noise"] = {"relative": 0.01, "floor": 1e-8}
    if probes is not None:
        document["probes"] = [{"id": f"P{i}", "shaft": "S", **one} for i, one in enumerate(probes)]
    return parse_machine({**document, **changes})


def measured(machine: Machine, speed: Floats) -> Measurement:
    rng = np.random.default_rng(2)
    return Measurement.of(speed=speed, phasor=measured_phasors(machine, draw_truth(machine, rng), speed, rng))


def test_one_pair_alone_cannot_tell_a_swap_from_the_sense_of_rotation() -> None:
    machine = one_disc()
    (one,) = orbit_findings(machine, swapped(measured(machine, np.linspace(15, 200, 60)), (0, 1)))
    assert one.code == "swapped_or_wrong_rotation"


@pytest.mark.parametrize(
    ("probes", "speed", "words"),
    [
        ([{"station": 0.5, "angle_deg": 0}], (15, 200), "one probe alone"),
        ([{"station": 0.5, "angle_deg": 0}, {"station": 0.5, "angle_deg": 180}], (15, 200), "along one line"),
        (None, (400, 600), "0 samples below"),
        (None, (100, 101), "too near to each other"),
    ],
)
def test_what_cannot_be_seen_is_said(probes: list[dict[str, Any]] | None, speed: tuple[float, float], words: str) -> None:
    machine = one_disc(probes=probes)
    (one,) = orbit_findings(machine, measured(machine, np.linspace(*speed, 40)))
    assert one.code == "orbit_sense_undetectable"
    assert words in one.words


def test_orbits_below_the_noise_say_nothing() -> None:
    machine = one_disc()
    rng = np.random.default_rng(4)
    errors: Complexes = rng.standard_normal((60, 2)) + 1j * rng.standard_normal((60, 2))
    (one,) = orbit_findings(machine, Measurement.of(speed=np.linspace(15, 200, 60), phasor=1e-6 * errors))
    assert "too small for the noise" in one.words


def test_a_document_without_stiffnesses_says_nothing() -> None:
    document = chapter_3_document()
    del document["bearings"][2]["kxx"]
    machine = parse_machine(document)
    found = orbit_findings(machine, run("thesis-chapter-3"))
    assert {one.code for one in found} == {"orbit_sense_undetectable"}
    assert all("no stiffness of bearing B3" in one.words for one in found)


def test_chance_of_forward_orbits_is_that_of_drawn_unbalances() -> None:
    machine = example("sealed-pump")
    expected = ExpectedOrbits.of(machine)
    place = next(one for one in probe_stations(machine) if one.channels == ("C2L", "C2R"))
    rng = np.random.default_rng(0)
    discs = len(machine.discs)
    unbalance = rng.standard_normal((20_000, discs)) + 1j * rng.standard_normal((20_000, discs))
    grown = np.einsum("s,smp->mp", expected.growth(expected.speed), expected.influence)
    x, y = np.linalg.pinv(place.directions) @ grown[list(place.columns)] @ unbalance.T
    drawn = float(np.mean(np.abs(x + 1j * y) > np.abs(x - 1j * y)))
    assert expected.chance_forward(place, direction=1) == pytest.approx(drawn, abs=0.01)


def test_orbits_of_any_two_angles_are_the_same_ellipse() -> None:
    # x = 3, y = -j: a forward ellipse along x with semi-axes 3 and 1, in micrometres.
    x, y = 3e-6, -1e-6j
    for first, second in ((0, 90), (135, 45), (10, 75)):
        machine = one_disc(probes=[{"station": 0.5, "angle_deg": a} for a in (first, second)])
        rows = [x * np.cos(np.deg2rad(a)) + y * np.sin(np.deg2rad(a)) for a in (first, second)]
        (one,) = station_orbits(machine, Measurement.of(speed=np.array([50.0]), phasor=np.array([rows])))
        assert one.semi_major[0] == pytest.approx(3e-6)
        assert one.semi_minor[0] == pytest.approx(1e-6)
        assert one.inclination[0] == pytest.approx(0.0, abs=1e-9)
        assert one.sense(0) == "forward"
        (back,) = station_orbits(machine, Measurement.of(speed=np.array([50.0]), phasor=np.array([rows]), direction=-1.0))
        assert back.sense(0) == "backward"


@pytest.mark.parametrize("angles", [(0.0, 90.0), (135.0, 45.0), (0.0, 50.0, 130.0)])
def test_errors_of_an_orbit_are_those_of_drawn_noise(angles: tuple[float, ...]) -> None:
    probes = [{"station": 0.5, "angle_deg": a, "run_out_spread": 2e-8 * i} for i, a in enumerate(angles)]
    machine = one_disc(probes=probes)
    x, y = 3e-6 * np.exp(0.4j), 1.2e-6 * np.exp(-1.6j)
    clean = np.array([x * np.cos(np.deg2rad(a)) + y * np.sin(np.deg2rad(a)) for a in angles])
    scatter = np.array([4e-8, 9e-8, 6e-8][: len(angles)])
    whole = np.hypot(scatter, [one["run_out_spread"] for one in probes])
    rng = np.random.default_rng(6)
    draws = 20_000
    noise = rng.standard_normal((draws, len(angles))) + 1j * rng.standard_normal((draws, len(angles)))
    phasor = clean + whole / np.sqrt(2) * noise
    shape = phasor.shape
    measurement = Measurement(
        np.full(draws, 50.0), np.ones(draws), phasor, np.ones(shape, bool), np.broadcast_to(scatter, shape).copy()
    )
    (one,) = station_orbits(machine, measurement)
    for name in ("semi_major", "semi_minor", "inclination"):
        told = float(np.median(getattr(one, f"{name}_error")))
        assert told == pytest.approx(float(np.std(getattr(one, name))), rel=0.03), name


def test_a_circle_has_no_inclination() -> None:
    phasor = np.array([[1e-6, -1e-6j]])
    (one,) = station_orbits(one_disc(), Measurement.of(speed=np.array([50.0]), phasor=phasor))
    assert one.inclination_error[0] > np.pi
    assert one.sense(0) == "forward"


def test_an_unusable_channel_leaves_no_orbit() -> None:
    machine = chapter_3()
    phasor = np.full((1, 8), 1e-5 + 0j)
    phasor[0, 0] = np.nan
    found = station_orbits(machine, Measurement.of(speed=np.array([50.0]), phasor=phasor))
    assert np.isnan(found[0].semi_major[0])
    assert found[0].sense(0) == "undecided"
    assert np.isfinite(found[1].semi_major[0])


def test_nothing_measured_is_no_orbit_and_no_finding() -> None:
    machine = chapter_3()
    still = Measurement.of(speed=np.linspace(10, 90, 20), phasor=np.zeros((20, 8), dtype=complex))
    assert {one.code for one in orbit_findings(machine, still)} == {"orbit_sense_undetectable"}
    assert all(one.sense(0) == "undecided" for one in station_orbits(machine, still))
    none = still.pick(np.zeros(20, dtype=bool))
    assert all("0 samples below" in one.words for one in orbit_findings(machine, none))
    assert all(one.x.size == 0 for one in station_orbits(machine, none))
