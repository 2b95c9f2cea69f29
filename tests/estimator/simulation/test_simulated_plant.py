"""The simulated plant: its sweeps, its truth and noise, and that a scenario changes what it tells of and nothing else."""

from typing import get_args

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.machine.rules import Noise
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.runs.segmentation import RunEnded, RunKind, RunStarted, SweepLimits, SweepState, advance, finish
from estimator.simulation.scenarios import Scenario
from estimator.simulation.simulated_plant import (
    BEARING_STIFFENING,
    COUPLING_STIFFENING,
    OTHER_RUN_SCATTER,
    RUN_SCATTER,
    TRUTH_SPREAD,
    UNBALANCE_GROWTH,
    Truth,
    draw_truth,
    measured_phasors,
    noise,
    speed_law,
    swept_phasors,
    truth_at_progress,
    truth_of_run,
)
from estimator.units import rad_per_s_to_rpm
from tests.estimator.sweeps import fast_coast_down, light_chapter_3, steady
from tests.estimator.trains import Floats, chapter_3, chapter_3_document, one_disc_document, without

MACHINE = chapter_3()
KINDS = pytest.mark.parametrize("kind", get_args(RunKind))


def truth(seed: int = 1) -> Truth:
    return draw_truth(MACHINE, np.random.default_rng(seed))


# --- sweeps ---------------------------------------------------------------------------------------------------------


@KINDS
@pytest.mark.parametrize("samples", [2, 3, 200])
def test_a_sweep_is_monotone_and_covers_the_speed_range(kind: RunKind, samples: int) -> None:
    seconds, speed = speed_law(MACHINE, kind, duration=300.0, samples=samples)
    assert seconds.shape == speed.shape == (samples,)
    assert (seconds[0], seconds[-1]) == (0.0, 300.0)
    assert np.all(np.diff(seconds) > 0)
    assert np.all(np.diff(speed) > 0 if kind == "run-up" else np.diff(speed) < 0)
    rpm = sorted(rad_per_s_to_rpm(value) for value in (speed[0], speed[-1]))
    assert rpm == pytest.approx([0.95 * 90, 0.999 * 6000])


def test_a_run_up_is_a_run_down_mirrored_in_time() -> None:
    _, down = speed_law(MACHINE, "run-down", duration=300.0, samples=50)
    _, up = speed_law(MACHINE, "run-up", duration=300.0, samples=50)
    assert np.array_equal(up, down[::-1])


def test_a_coast_down_slows_down_less_and_less() -> None:
    """Drag falls with speed: three times as large at the top as near standstill."""
    _, speed = speed_law(MACHINE, "run-down", duration=300.0, samples=300)
    drag = -np.diff(speed)
    assert np.all(np.diff(drag) < 1e-9 * drag[0])
    assert drag[0] / drag[-1] == pytest.approx(3.0, rel=0.1)


@KINDS
def test_a_sweep_is_seen_as_one_run(kind: RunKind) -> None:
    seconds, speed = speed_law(MACHINE, kind, duration=300.0, samples=200)
    limits, state = SweepLimits.of(MACHINE.speed_range), SweepState()
    events: list[RunStarted | RunEnded] = []
    for second, value in zip(seconds, speed, strict=True):
        state, new = advance(state, limits, time=round(second * 1e9), speed=value, direction=1)
        events += new
    events += finish(state, limits, reason="the sweep is over")[1]
    assert [type(event) for event in events] == [RunStarted, RunEnded]
    assert {event.kind for event in events} == {kind}


# --- truth ----------------------------------------------------------------------------------------------------------


def assert_same(one: Truth, other: Truth) -> None:
    assert one.unknowns.names == other.unknowns.names
    assert np.array_equal(one.coefficients, other.coefficients)
    assert np.array_equal(one.unbalances, other.unbalances)
    assert one.factors == other.factors


def test_the_truth_is_settled_by_the_seed() -> None:
    assert_same(truth(), truth())
    assert_same(truth_of_run(truth(), np.random.default_rng(5)), truth_of_run(truth(), np.random.default_rng(5)))
    assert not np.array_equal(truth(1).coefficients, truth(2).coefficients)


def test_a_machine_is_near_its_document_but_not_at_it() -> None:
    nominal = np.array([c.nominal for c in truth().unknowns.coefficients])
    off = np.concatenate([np.log(truth(seed).coefficients / nominal) for seed in range(40)])
    assert off.std() == pytest.approx(TRUTH_SPREAD, rel=0.1)
    assert abs(off.mean()) < 0.01


def test_runs_scatter_about_the_truth() -> None:
    rng = np.random.default_rng(3)
    fixed = truth()
    off = np.array([truth_of_run(fixed, rng).coefficients / fixed.coefficients - 1 for _ in range(300)])
    for quantity in ("stiffness", "damping", "angular stiffness"):
        which = [c.quantity == quantity for c in fixed.unknowns.coefficients]
        expected = RUN_SCATTER["damping"] if quantity == "damping" else OTHER_RUN_SCATTER
        assert off[:, which].std() == pytest.approx(expected, rel=0.1)


def test_unknown_cross_coupling_is_simulated_as_none() -> None:
    document = without(chapter_3_document(), ("bearings",), ("kxy", "kyx"))
    for disc, given in zip(document["discs"], chapter_3_document()["discs"], strict=True):
        disc["unbalance"] = given["unbalance"]
    drawn = draw_truth(parse_machine(document), np.random.default_rng(1))
    names = [c.name for c in drawn.unknowns.coefficients]
    assert drawn.coefficients[names.index("bearing.B1.kxy")] == 0.0


def test_missing_nominal_values_are_named() -> None:
    document = chapter_3_document()
    del document["bearings"][1]["cyy"]
    del document["couplings"][0]["k_phix"]
    del document["discs"][2]["unbalance"]
    with pytest.raises(ValueError, match="thesis-chapter-3") as caught:
        draw_truth(parse_machine(document), np.random.default_rng(1))
    named = str(caught.value).partition("nominal values of ")[2].split(", ")
    assert named == ["bearing.B2.cyy", "coupling.C1.k_phix", "disc.D3.unbalance"]


# --- scenarios --------------------------------------------------------------------------------------------------------


def growth(scenario: Scenario, progress: float) -> tuple[dict[str, float], dict[str, complex]]:
    """Factors by which a scenario has changed coefficients and unbalances, where it has."""
    before = truth()
    after = truth_at_progress(before, MACHINE, scenario, progress)
    changed = np.flatnonzero(after.coefficients != before.coefficients)
    names = [c.name for c in before.unknowns.coefficients]
    coefficients = {names[i]: float(after.coefficients[i] / before.coefficients[i]) for i in changed}
    turned = np.flatnonzero(after.unbalances != before.unbalances)
    planes = [plane.name for plane in before.unknowns.unbalances]
    return coefficients, {planes[i]: complex(after.unbalances[i] / before.unbalances[i]) for i in turned}


@pytest.mark.parametrize("progress", [0.0, 0.5, 1.0])
def test_a_healthy_machine_does_not_change(progress: float) -> None:
    assert growth("healthy", progress) == ({}, {})


@pytest.mark.parametrize("scenario", get_args(Scenario))
def test_a_scenario_that_has_not_begun_changes_nothing(scenario: Scenario) -> None:
    assert growth(scenario, 0.0) == ({}, {})


@pytest.mark.parametrize("progress", [0.25, 1.0])
def test_misalignment_stiffens_the_coupling_and_the_bearings_beside_it(progress: float) -> None:
    coefficients, unbalances = growth("misalignment", progress)
    by_element: dict[str, list[float]] = {}
    for name, factor in coefficients.items():
        by_element.setdefault(name.rsplit(".", 1)[0], []).append(factor)
    assert by_element.keys() == {"coupling.C1", "bearing.B2", "bearing.B3"}
    assert by_element["coupling.C1"] == pytest.approx([1 + progress * COUPLING_STIFFENING] * 10)
    for bearing in ("bearing.B2", "bearing.B3"):
        assert by_element[bearing] == pytest.approx([1 + progress * BEARING_STIFFENING] * 8)
    assert unbalances == {}


@pytest.mark.parametrize("progress", [0.25, 1.0])
def test_unbalance_changes_one_disc_only(progress: float) -> None:
    coefficients, unbalances = growth("unbalance", progress)
    assert coefficients == {}
    assert unbalances == {"disc.D1.unbalance": pytest.approx(1 + progress * (UNBALANCE_GROWTH - 1))}


def test_a_scenario_leaves_the_truth_that_it_began_with() -> None:
    before = truth()
    for scenario in get_args(Scenario):
        truth_at_progress(before, MACHINE, scenario, 1.0)
    assert_same(before, truth())


def test_a_machine_without_coupling_cannot_be_misaligned() -> None:
    single = parse_machine(one_disc_document())
    with pytest.raises(ValueError, match="'one-disc' has no coupling"):
        truth_at_progress(draw_truth(single, np.random.default_rng(1)), single, "misalignment", 0.5)


# --- noise ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("relative", "floor"), [(0.01, 0.0), (0.05, 2e-6), (1e-6, 1e-6)])
def test_noise_has_the_rms_of_the_document(relative: float, floor: float) -> None:
    """Half of it in the real and half in the imaginary part; 3 % is 5 standard errors of the rms of 20,000 pairs."""
    clean = np.full((20_000, 2), 3e-5 * np.exp(0.4j))
    errors = noise(Noise(relative=relative, floor=floor), clean, np.random.default_rng(1))
    expected = np.hypot(relative * 3e-5, floor)
    assert np.sqrt(np.mean(np.abs(errors) ** 2)) == pytest.approx(expected, rel=0.03)
    assert errors.real.std() == pytest.approx(expected / np.sqrt(2), rel=0.03)
    assert errors.imag.std() == pytest.approx(expected / np.sqrt(2), rel=0.03)
    assert abs(np.mean(errors.real * errors.imag)) < 0.03 * expected**2


def deviation(speed: Floats, seed: int) -> Floats:
    """Measured minus clean response in parts of the amplitude."""
    quiet = chapter_3_document() | {"noise": {"relative": 1e-12, "floor": 0.0}}
    clean = measured_phasors(parse_machine(quiet), truth(), speed, np.random.default_rng(0))
    measured = measured_phasors(MACHINE, truth(), speed, np.random.default_rng(seed))
    return np.abs(measured - clean) / np.abs(clean)


def test_measured_phasors_carry_that_noise() -> None:
    speed = np.linspace(20.0, 300.0, 400)
    found = deviation(speed, seed=1)
    assert found.shape == (400, len(MACHINE.channels))
    assert np.sqrt(np.mean(found**2)) == pytest.approx(0.01, rel=0.06)
    assert not np.array_equal(found, deviation(speed, seed=2))


def test_a_fast_sweep_rings_on_as_an_integration_in_time_does() -> None:
    """The phasors of a train that coasts down in 100 s, beside those of `coast_down`; the steady state is far from both."""
    moved = fast_coast_down()
    document = light_chapter_3().model_dump(mode="json") | {"noise": {"relative": 1e-12, "floor": 0.0}}
    machine = parse_machine(document)
    train = unknowns(machine, assemble_rotor(machine))
    as_documented = Truth(
        train,
        np.array([one.expected for one in train.coefficients]),
        np.array([one.nominal for one in train.unbalances], dtype=complex),
        {},
    )
    time = np.linspace(5.0, 100.0, 200)
    speed = moved.law.speed(time)
    true, still = moved.envelope(time), steady(machine, speed)
    found = swept_phasors(machine, as_documented, time=time, speed=speed, rng=np.random.default_rng(1))
    off, added = np.linalg.norm(found - true), np.linalg.norm(still - true)
    assert added > 0.05 * np.linalg.norm(still)
    assert off < 0.1 * added


def test_a_machine_that_turns_the_other_way_responds_otherwise() -> None:
    speed = np.linspace(50.0, 200.0, 5)
    backwards = parse_machine(chapter_3_document() | {"rotation": "negative"})
    one, other = (measured_phasors(machine, truth(), speed, np.random.default_rng(1)) for machine in (MACHINE, backwards))
    assert not np.allclose(one, other, rtol=0.1)
