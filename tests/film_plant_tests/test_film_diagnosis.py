"""Tests that what happens to plants of other make is called by its name: gated fits of a few runs, assessed as the service
does."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from msgspec import structs

from estimator.alignment.alignment_comparison import compared_alignment
from estimator.diagnosis.compared_identifications import compared_identifications
from estimator.diagnosis.observation import observed_fit
from estimator.fit.identification import Identification
from estimator.identification.quality_gate import identify_gated
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.channel_status import ChannelStatus
from estimator.phasors.recorded_run import RecordedRun
from estimator.updated_model.model import updated_model
from service.monitoring.assessment.assess import assess
from service.monitoring.assessment.context import AssessedRun, AssessmentBasis, AssessmentContext, MachineDiagnosis
from service.monitoring.rules.limits import Limits
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured
from tests.film_plant.misalignment import SETTLED, left_off, moved
from tests.film_plant.oil import walther
from tests.film_plant.plant import Plant
from tests.film_plant.plants import Priors, motor_compressor_plant
from tests.film_plant.scatter import run_of
from tests.film_plant.train import ConstantOil

BASELINE = 5
WIDE = Priors(elevation=150e-6, rigid_elevation=150e-6)
WEEK = 7 * 86_400 * 1_000_000_000
PlantChange = Callable[[Plant], Plant]


@cache
def plant() -> Plant:
    return motor_compressor_plant(2, "rigid", priors=SETTLED, discrepancy=DiscrepancySize(), alter=left_off("rigid"))


@cache
def machine() -> Machine:
    return parse_machine(film_document(plant(), priors=WIDE))


def gated(
    one: Plant,
    seed: int,
    beginning: Identification | None,
    *,
    gains: Mapping[str, float] | None = None,
    run_outs: Mapping[str, complex] | None = None,
    of: Machine | None = None,
) -> Identification:
    """Identify a run of a plant through the gate.

    gains: factors on what single probes read [-]. run_outs: what is added to that [m]. of: its machine; None for the one of
    these tests.
    """
    described = of or machine()
    measurement = measured(one, seed=seed)
    reads = np.array([(gains or {}).get(channel, 1.0) for channel in described.channels])
    added = np.array([(run_outs or {}).get(channel, 0.0) for channel in described.channels])
    measurement = structs.replace(measurement, phasor=measurement.phasor * reads + added)
    status = np.full(measurement.phasor.shape, ChannelStatus.GOOD, np.uint8)
    run = RecordedRun(None, measurement.speed, measurement.phasor, status, measurement.scatter, described.channels)
    begin = None if beginning is None else beginning.point
    found = identify_gated(described, [run], [measurement], beginning=begin).identification
    assert found is not None
    return found


@cache
def baseline() -> tuple[Identification, ...]:
    rng = np.random.default_rng(2)
    first = gated(run_of(plant(), rng), 0, None)
    return (first, *(gated(run_of(plant(), rng), number, first) for number in range(1, BASELINE)))


def assessed(number: int, one: Identification) -> AssessedRun:
    return AssessedRun(number, number * WEEK, {}, observed_fit(one))


def diagnosed(
    change: PlantChange,
    *,
    runs: int = 2,
    gains: Mapping[str, float] | None = None,
    run_outs: Mapping[str, complex] | None = None,
) -> MachineDiagnosis:
    """Diagnosis of the newest runs of the plant after something has happened to it."""
    rng, later = np.random.default_rng(3), change(plant())
    first = baseline()[0]
    after = [gated(run_of(later, rng), 100 + number, first, gains=gains, run_outs=run_outs) for number in range(runs)]
    context = AssessmentContext(
        machine=machine(),
        limits=Limits(),
        basis=AssessmentBasis(None, None),
        baseline=tuple(assessed(number, one) for number, one in enumerate(baseline()) if one.accepted),
        after=tuple(assessed(BASELINE + number, one) for number, one in enumerate(after)),
        open_causes=(),
        history=None,
        open_rates={},
    )
    found = assess(context).diagnosis
    assert found is not None
    return found


def sizes(found: MachineDiagnosis) -> dict[tuple[str, str], Mapping[str, float]]:
    return {(one.cause.kind, one.cause.element): one.size.quantities for one in found.causes}


def sunk(by: float) -> PlantChange:
    return lambda one: replace(one, train=moved(one.train, offset=np.array([0.0, -by]), angle=np.zeros(2)))


def thickened(factor: float) -> PlantChange:
    def change(one: Plant) -> Plant:
        bearings = []
        for bearing in one.train.bearings:
            assert isinstance(bearing.oil, ConstantOil)
            bearings.append(replace(bearing, oil=ConstantOil(factor * bearing.oil.value)))
        return replace(one, train=replace(one.train, bearings=tuple(bearings)))

    return change


def worn(number: int, factor: float) -> PlantChange:
    def change(one: Plant) -> Plant:
        bearings = list(one.train.bearings)
        bearings[number] = replace(bearings[number], clearance=factor * bearings[number].clearance)
        return replace(one, train=replace(one.train, bearings=tuple(bearings)))

    return change


def test_a_shaft_that_sinks_by_100_um_is_a_misalignment_of_that_size() -> None:
    (one,) = diagnosed(sunk(100e-6)).causes
    assert (one.cause.kind, one.cause.element) == ("misalignment", "coupling.C1")
    assert one.size.quantities["offset_vertical_um"] == pytest.approx(-100.0, rel=0.3)
    assert one.size.beyond_tolerance is not None
    assert one.size.beyond_tolerance > 0.95


def test_a_small_step_is_a_change_and_no_alarm() -> None:
    (one,) = diagnosed(sunk(20e-6), runs=3).causes
    assert (one.cause.kind, one.cause.element) == ("misalignment", "coupling.C1")
    assert one.size.quantities["offset_vertical_um"] == pytest.approx(-20.0, rel=0.3)
    assert one.size.beyond_tolerance is not None
    assert one.size.beyond_tolerance < 0.01


def test_oil_that_is_10_kelvin_colder_is_nothing() -> None:
    assert diagnosed(thickened(walther(46, 40.0) / walther(46, 50.0)), runs=3).causes == ()


def test_a_clearance_that_is_15_per_cent_larger_is_wear() -> None:
    (one,) = diagnosed(worn(1, 1.15)).causes
    assert (one.cause.kind, one.cause.element) == ("wear", "bearing.B2")
    assert one.size.per_cent == pytest.approx(15.0, abs=4.0)


@pytest.mark.parametrize(
    ("other", "named"),
    [
        (worn(1, 1.15), {("wear", "bearing.B2")}),
        pytest.param(worn(2, 1.3), {("wear", "bearing.B3")}, marks=pytest.mark.long),
        pytest.param(thickened(1.6), set(), marks=pytest.mark.long),  # a season may bring as much
    ],
    ids=["worn", "far worn", "thicker oil"],
)
def test_an_offset_beside_another_cause_is_reported_within_its_interval(
    other: PlantChange, named: set[tuple[str, str]]
) -> None:
    found = {(one.cause.kind, one.cause.element): one for one in diagnosed(lambda one: other(sunk(100e-6)(one))).causes}
    moved = {(kind, element) for kind, element in found if kind != "light_load"}  # which a sunk bearing may have besides
    assert moved == {("misalignment", "coupling.C1"), *named}
    told = found["misalignment", "coupling.C1"].size.quantities
    assert told["offset_vertical_um"] == pytest.approx(-100.0, abs=told["offset_vertical_half_width_um"])
    assert told["offset_vertical_half_width_um"] < 20.0


def running_out(*, offset: complex = 0j, angle: complex = 0j) -> PlantChange:
    def change(one: Plant) -> Plant:
        return replace(one, train=replace(one.train, couplings=(replace(one.train.couplings[0], run_out=(offset, angle)),)))

    return change


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "quantity", "size"),
    [
        (running_out(offset=2e-6 * np.exp(0.8j)), "offset_um", 2.0),
        pytest.param(running_out(angle=10e-6j), "angle_urad", 10.0, marks=pytest.mark.long),
    ],
    ids=["bore", "face"],
)
def test_the_run_out_of_a_rigid_coupling_is_named_with_its_size(change: PlantChange, quantity: str, size: float) -> None:
    (one,) = diagnosed(change).causes
    assert (one.cause.kind, one.cause.element) == ("rotating_coupling", "coupling.C1")
    assert one.size.quantities[quantity] == pytest.approx(size, rel=0.15)


@pytest.mark.long
def test_an_offset_beside_a_probe_that_reads_too_much_is_told_with_intervals_that_hold() -> None:
    """Held at what the document says, the gain would be told as a horizontal offset and as angles."""
    found = sizes(diagnosed(sunk(40e-6), gains={"B2X": 1.08}))
    assert set(found) == {("misalignment", "coupling.C1"), ("sensor", "probe.B2X")}
    told = found["misalignment", "coupling.C1"]
    for quantity, true in (("offset_vertical", -40.0), ("offset_horizontal", 0.0)):
        assert told[f"{quantity}_um"] == pytest.approx(true, abs=1.5 * told[f"{quantity}_half_width_um"]), quantity
    for quantity in ("angle_vertical", "angle_horizontal"):
        assert told[f"{quantity}_urad"] == pytest.approx(0.0, abs=1.5 * told[f"{quantity}_half_width_urad"]), quantity


def test_a_comparison_of_two_runs_calls_wear_no_change_of_the_alignment() -> None:
    later = gated(run_of(worn(2, 1.3)(plant()), np.random.default_rng(4)), 100, baseline()[0])
    found = compared_identifications(machine(), baseline()[0], later, "C1")
    assert found.others == (("wear", "bearing.B3"),)
    assert found.verdict == (
        "no change of the alignment of C1 is certain; wear at bearing.B3 is named, and what it has moved is left open"
    )


@pytest.mark.long
def test_a_comparison_beside_a_probe_that_reads_too_much_leaves_open_what_that_has_moved() -> None:
    later = gated(run_of(sunk(40e-6)(plant()), np.random.default_rng(5)), 100, baseline()[0], gains={"B2X": 1.08})
    found = compared_identifications(machine(), baseline()[0], later, "C1")
    assert found.others == (("sensor", "probe.B2X"),)
    told = {one.name.rpartition(".")[2]: one for one in found.changes}
    for quantity, true in (("offset_vertical", -40e-6), ("offset_horizontal", 0.0)):
        assert told[quantity].value == pytest.approx(true, abs=1.5 * told[quantity].half), quantity


@pytest.mark.parametrize("channel", ["B1X", pytest.param("B3Y", marks=pytest.mark.long)])
def test_a_probe_that_read_too_little_in_the_earlier_run_is_no_change_of_the_alignment(channel: str) -> None:
    """With the gain as the document has it, an angle or an offset would have changed; estimates allow for it."""
    before = gated(run_of(plant(), np.random.default_rng(6)), 101, baseline()[0], gains={channel: 0.93})
    later = gated(run_of(plant(), np.random.default_rng(5)), 100, baseline()[0])
    assert before.accepted
    assert "another gain than" in before.verdict
    own = compared_alignment([updated_model(machine(), before)], updated_model(machine(), later), "C1")
    assert own.verdict.startswith("no change of the alignment of C1 is certain")
    found = compared_identifications(machine(), before, later, "C1")
    assert found.others == (("sensor", f"probe.{channel}"),)
    assert found.verdict.startswith("no change of the alignment of C1 is certain")


@pytest.mark.parametrize("size", [*(pytest.param(one, marks=pytest.mark.long) for one in (0.7, 2.0)), 15.0])
def test_a_run_out_of_one_probe_is_told_with_its_size_and_nothing_else_is(size: float) -> None:
    """Films may take up a small one by deviating; a large one leaves nothing of the channel."""
    found = diagnosed(lambda one: one, run_outs={"B4X": size * 1e-6 * np.exp(0.7j)})
    assert found.causes[0].size.parts[0].value == pytest.approx(size, rel=0.1, abs=0.06)
    assert set(sizes(found)) == {("run_out", "probe.B4X")}


@pytest.mark.long
@pytest.mark.parametrize(
    ("run_outs", "gains", "fault"),
    [({"B2X": 4e-6 + 2e-6j}, None, ("run_out", "probe.B2X")), (None, {"B2X": 1.2}, ("sensor", "probe.B2X"))],
    ids=["run-out", "gain"],
)
def test_a_misalignment_shows_beside_a_probe_for_which_no_fit_is_accepted(
    run_outs: dict[str, complex] | None, gains: dict[str, float] | None, fault: tuple[str, str]
) -> None:
    told = sizes(diagnosed(sunk(60e-6), run_outs=run_outs, gains=gains))
    assert set(told) == {("misalignment", "coupling.C1"), fault}
    offset = told["misalignment", "coupling.C1"]
    assert offset["offset_vertical_um"] == pytest.approx(-60.0, abs=1.5 * offset["offset_vertical_half_width_um"])
    assert offset["offset_vertical_half_width_um"] < 15.0
