"""The sign of misalignment: coupling and neighbouring bearings stiffer together; neither of them alone, and nothing else."""

import numpy as np
import pytest
from trains import chapter_3, chapter_3_document

from estimator.baseline import Point
from estimator.machine import Machine, parse_machine
from estimator.misalignment import (
    MisalignmentEvidence,
    determines,
    misalignment_evidence,
    neighbouring_bearings,
    watched,
)

NAMES = tuple(
    f"{e}.{k}" for e in ("bearing.B1", "bearing.B2", "bearing.B3", "bearing.B4", "coupling.C1") for k in ("kxx", "kyy")
)
COUPLING, BESIDE, APART = ("coupling.C1.",), ("bearing.B2.", "bearing.B3."), ("bearing.B1.", "bearing.B4.")
RUNS = 5


def point(rng: np.random.Generator, shifts: dict[str, float], names: tuple[str, ...] = NAMES) -> Point:
    """Logarithms with 0.5 % errors and 1 % run-to-run scatter; `shifts` by the beginning of the name."""
    value = 0.01 * rng.standard_normal(len(names)) + 0.005 * rng.standard_normal(len(names))
    value += [next((size for start, size in shifts.items() if name.startswith(start)), 0.0) for name in names]
    return Point(names, value, 0.005**2 * np.eye(len(names)))


def at_the_coupling(baseline: list[Point], now: Point) -> MisalignmentEvidence:
    machine = chapter_3()
    return misalignment_evidence(machine, machine.couplings[0], baseline, now)


def evidence(shifts: dict[str, float], *, seed: int = 1) -> MisalignmentEvidence:
    rng = np.random.default_rng(seed)
    baseline = [point(rng, {}) for _ in range(RUNS)]
    return at_the_coupling(baseline, point(rng, shifts))


def shifted(*parts: tuple[str, ...], by: float = 0.1) -> dict[str, float]:
    return {start: by for part in parts for start in part}


SEEDS = pytest.mark.parametrize("seed", range(5))


@SEEDS
def test_coupling_and_bearings_together_are_misalignment(seed: int) -> None:
    one = evidence(shifted(COUPLING, BESIDE, by=0.15), seed=seed)
    assert one.coupling == "C1"
    assert one.found
    assert one.together is not None
    assert one.together.shift == pytest.approx(0.15, abs=0.03)


@SEEDS
@pytest.mark.parametrize(
    "shifts",
    [
        pytest.param({}, id="nothing"),
        pytest.param({"bearing.B2.": 0.5}, id="one bearing alone"),
        pytest.param(shifted(COUPLING, by=0.5), id="coupling alone"),
        pytest.param(shifted(BESIDE, by=0.5), id="bearings alone"),
        pytest.param(shifted(COUPLING, APART, by=0.5), id="coupling and the bearings at the ends"),
        pytest.param(shifted(COUPLING, BESIDE, by=-0.15), id="both softer"),
        pytest.param(shifted(COUPLING, by=0.3) | shifted(BESIDE, by=-0.1), id="apart from each other"),
        pytest.param(shifted(COUPLING, BESIDE, by=0.005), id="too little to matter"),
    ],
)
def test_nothing_else_is(shifts: dict[str, float], seed: int) -> None:
    assert not evidence(shifts, seed=seed).found


def test_a_shift_below_two_per_cent_is_none_however_certain() -> None:
    sure = Point(NAMES, np.zeros(len(NAMES)), 1e-12 * np.eye(len(NAMES)))
    rng = np.random.default_rng(0)
    many = [Point(NAMES, 1e-6 * rng.standard_normal(len(NAMES)), sure.covariance) for _ in range(300)]
    values = np.array([0.0195 if name.startswith(COUPLING + BESIDE) else 0.0 for name in NAMES])
    below = at_the_coupling(many, Point(NAMES, values, sure.covariance))
    above = at_the_coupling(many, Point(NAMES, 1.05 * values, sure.covariance))
    assert above.found
    assert not below.found


def test_what_the_evidence_names_is_what_it_weighed() -> None:
    one = evidence({})
    assert one.together is not None
    assert one.coupling_alone is not None
    assert one.bearings_alone is not None
    assert one.coupling_alone.names == ("coupling.C1.kxx", "coupling.C1.kyy")
    assert one.bearings_alone.names == ("bearing.B2.kxx", "bearing.B2.kyy", "bearing.B3.kxx", "bearing.B3.kyy")
    assert one.together.names == one.coupling_alone.names + one.bearings_alone.names


@pytest.mark.parametrize("missing", [COUPLING, BESIDE, ("bearing.B2.kyy",)])
def test_what_lacks_a_watched_stiffness_determines_nothing(missing: tuple[str, ...]) -> None:
    machine = chapter_3()
    names = watched(machine, machine.couplings[0])
    rng = np.random.default_rng(1)
    assert determines(point(rng, {}), names)
    assert not determines(point(rng, {}, tuple(name for name in NAMES if not name.startswith(missing))), names)


def test_what_is_too_uncertain_determines_nothing() -> None:
    machine = chapter_3()
    names = watched(machine, machine.couplings[0])
    for error, expected in ((0.14, True), (0.16, False)):
        covariance = 1e-6 * np.eye(len(NAMES))
        covariance[NAMES.index("coupling.C1.kxx"), NAMES.index("coupling.C1.kxx")] = error**2
        assert determines(Point(NAMES, np.zeros(len(NAMES)), covariance), names) is expected


def test_a_coupling_without_bearings_beside_it_gives_no_finding() -> None:
    document = chapter_3_document()
    document["bearings"] = [one for one in document["bearings"] if one["shaft"] == "S9"] or document["bearings"][:1]
    document["bearings"][0]["shaft"] = "S3"
    document["shafts"] = [*document["shafts"], document["shafts"][0] | {"id": "S3"}]
    machine = parse_machine(document)
    rng = np.random.default_rng(1)
    one = misalignment_evidence(
        machine, machine.couplings[0], [point(rng, {}) for _ in range(RUNS)], point(rng, shifted(COUPLING, by=0.5))
    )
    assert one.bearings_alone is None
    assert not one.found


def test_false_alarms_are_rare() -> None:
    """At most 1e-4 of identifications are to give one by chance: none in 2,000 is what that means here."""
    rng = np.random.default_rng(9)
    alarms = 0
    for _ in range(2_000):
        baseline = [point(rng, {}) for _ in range(RUNS)]
        alarms += at_the_coupling(baseline, point(rng, {})).found
    assert alarms == 0


# --- neighbours -----------------------------------------------------------------------------------------------------


def neighbours(machine: Machine) -> tuple[str, ...]:
    return neighbouring_bearings(machine, machine.couplings[0])


def with_bearings(*places: tuple[str, str, float]) -> Machine:
    document = chapter_3_document()
    document["bearings"] = [{"id": name, "shaft": shaft, "station": station} for name, shaft, station in places]
    return parse_machine(document)


def test_the_bearings_beside_a_coupling_are_the_last_before_and_the_first_behind_it() -> None:
    assert neighbours(chapter_3()) == ("B2", "B3")


def test_the_order_in_the_document_does_not_matter() -> None:
    machine = with_bearings(("d", "S2", 1.25), ("b", "S1", 1.0), ("c", "S2", 0.25), ("a", "S1", 0.0))
    assert neighbours(machine) == ("b", "c")


def test_a_shaft_may_have_no_bearing() -> None:
    assert neighbours(with_bearings(("a", "S1", 0.0), ("b", "S1", 1.0))) == ("b",)
    assert neighbours(with_bearings(("c", "S2", 0.5))) == ("c",)


def test_each_coupling_of_a_longer_train_has_its_own() -> None:
    document = chapter_3_document()
    document["shafts"].append({"id": "S3", "sections": document["shafts"][0]["sections"]})
    document["bearings"].append(document["bearings"][0] | {"id": "B5", "shaft": "S3", "station": 0.5})
    document["couplings"].append(document["couplings"][0] | {"id": "C2", "driver": "S2", "driven": "S3"})
    machine = parse_machine(document)
    assert [neighbouring_bearings(machine, one) for one in machine.couplings] == [("B2", "B3"), ("B4", "B5")]


def test_a_spacer_without_bearings_is_stepped_over() -> None:
    document = chapter_3_document()
    document["shafts"].insert(1, {"id": "spacer", "sections": document["shafts"][0]["sections"]})
    first = document["couplings"][0]
    document["couplings"] = [first | {"driven": "spacer"}, first | {"id": "C2", "driver": "spacer", "driven": "S2"}]
    machine = parse_machine(document)
    assert [neighbouring_bearings(machine, one) for one in machine.couplings] == [("B2", "B3"), ("B2", "B3")]
