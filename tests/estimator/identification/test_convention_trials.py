"""Wrong conventions of a source: each is named when the fit is refused, equivalent ones together, and none on a right run."""

import copy
import math
from collections.abc import Sequence
from functools import cache

import numpy as np
import pytest
import yaml
from msgspec.structs import replace

from estimator.fit.identification import Options
from estimator.identification.convention_trials import ConventionVerdict, with_named_conventions
from estimator.identification.quality_gate import identify_gated
from estimator.identification.wrong_conventions import WrongConvention
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.phasors.recorded_run import RecordedRun
from estimator.simulation.simulated_plant import draw_truth, measured_phasors, speed_law
from tests.estimator.sweeps import recorded
from tests.estimator.trains import Complexes, Floats, chapter_3, chapter_3_document, dense_response, noisy, perturbed
from tests.paths import EXAMPLES

ONE = Options(starts=1, explain=False)
PAIRS = (1, 0, 3, 2, 5, 4, 7, 6)
NAMES = {
    "phase-sign": WrongConvention("", "", phase=-1.0),
    "rotation": WrongConvention("", "", turned=True),
    "phase-unit": WrongConvention("", "", phase=math.pi / 180.0),
    "speed-unit": WrongConvention("", "", speed=math.pi / 30.0),
    "swapped-probes": WrongConvention("", "", order=(0, 1, 2, 5, 4, 3, 6, 7)),
}


@cache
def document() -> Machine:
    """The Chapter 3 train with its coefficients off by up to 30 %."""
    told = perturbed(chapter_3_document(), seed=3, span=0.3)
    return parse_machine(told)


@cache
def right(samples: int = 50) -> tuple[Floats, Floats, Complexes]:
    """Times, speeds and phasors of a slow run-down."""
    rng = np.random.default_rng(5)
    seconds, speed = speed_law(chapter_3(), "run-down", duration=6000.0, samples=samples)
    return seconds, speed, measured_phasors(chapter_3(), draw_truth(chapter_3(), rng), speed, rng)


def sent(wrong: WrongConvention | None = None, *, samples: int = 50) -> tuple[RecordedRun, Measurement]:
    """The run as it arrives from a source with a wrong convention."""
    seconds, speed, phasor = right(samples)
    run, measurement = recorded(seconds, speed, phasor, chapter_3().channels)
    return (run, measurement) if wrong is None else (wrong.run(run), wrong.measurement(measurement))


def told(machine: Machine, *parts: tuple[RecordedRun, Measurement], names: Sequence[str] = ()) -> ConventionVerdict:
    runs, measurements = [run for run, _ in parts], [measurement for _, measurement in parts]
    gated = identify_gated(machine, runs, measurements, options=ONE)
    return with_named_conventions(machine, runs, measurements, gated, names=names)


@pytest.mark.parametrize("name", ["phase-sign", *(pytest.param(one, marks=pytest.mark.long) for one in list(NAMES)[1:])])
def test_each_wrong_convention_is_named(name: str) -> None:
    found = told(document(), sent(NAMES[name]))
    assert found.gated.identification is not None
    assert not found.gated.identification.accepted
    named = [one.convention.name for one in found.named]
    assert named[0] == name or name == "rotation"
    # A mirror image of the train, with pairs swapped, turns the other way: nothing in the run tells the two apart.
    assert sorted(named) == (["rotation", "swapped-probes"] if name == "rotation" else [name])
    assert found.named[0].accepted
    assert found.named[0].improvement > 100.0
    assert found.gated.identification.verdict.startswith("the run fits over 1000 times better with ")
    if name == "swapped-probes":
        assert found.named[0].convention.words == "B2Y and B3Y swapped with each other"
    if name == "speed-unit":
        assert found.named[0].convention.words == "speeds in rad/s that were sent as r/min"


ONE_WRONG = {
    "phase-sign": NAMES["phase-sign"],
    "speed-unit": NAMES["speed-unit"],
    "amplitude-kind": WrongConvention("", "", amplitude=0.5),
    "amplitude-unit": WrongConvention("", "", amplitude=1e-3),
}


def with_one_wrong(name: str, *, names: Sequence[str] = ()) -> ConventionVerdict:
    """Three runs of one mounting, the second of which arrives with a wrong convention. names: of the runs."""
    added = np.zeros(len(document().discs), dtype=complex)
    parts = [sent(), sent(ONE_WRONG[name]), sent()]
    return told(document(), *((run, measured.with_trial_weight(added)) for run, measured in parts), names=names)


@pytest.mark.long
@pytest.mark.parametrize("name", ONE_WRONG)
def test_one_wrong_run_among_right_ones_is_named(name: str) -> None:
    found = with_one_wrong(name)
    assert found.named
    assert {(one.convention.name, one.run, one.accepted) for one in found.named} == {(name, 1, True)}
    assert found.gated.identification is not None
    assert " in run 2 of 3 alone" in found.gated.identification.verdict


def test_one_wrong_run_is_called_by_its_file() -> None:
    found = with_one_wrong("speed-unit", names=["one.csv", "two.csv", "three.csv"])
    assert {(one.convention.name, one.run, one.accepted) for one in found.named} == {("speed-unit", 1, True)}
    assert found.gated.identification is not None
    assert found.gated.identification.verdict.startswith("the runs fit ")
    assert " in two.csv alone" in found.gated.identification.verdict


@pytest.mark.long
def test_every_pair_swapped_and_the_other_sense_of_rotation_are_named_together() -> None:
    found = told(document(), sent(WrongConvention("", "", order=PAIRS)))
    assert {one.convention.name for one in found.named} == {"rotation", "swapped-probes"}
    assert found.gated.identification is not None
    assert "or equally well with" in found.gated.identification.verdict


@pytest.mark.parametrize(("part", "factor"), [("mass", 1.3), pytest.param("polar_inertia", 3.0, marks=pytest.mark.long)])
def test_nothing_is_named_on_a_right_run_that_a_wrong_document_refuses(part: str, factor: float) -> None:
    wrong = chapter_3_document()
    wrong["discs"][0][part] *= factor
    if part == "mass":
        wrong["shafts"][0]["sections"][0]["outer_diameter"] *= 1.1
    found = told(parse_machine(wrong), sent())
    assert found.gated.identification is not None
    assert found.named == ()
    assert "times better" not in found.gated.identification.verdict


@pytest.mark.long
def test_nothing_is_named_on_a_right_run_whose_stated_scatter_is_far_too_small() -> None:
    run, measurement = sent(samples=100)  # the gate leaves many out
    stated = replace(measurement, scatter=np.full(measurement.phasor.shape, 1e-7))
    strict = parse_machine(chapter_3_document() | {"noise": {"relative": 0.001}})
    found = told(strict, (run, stated))
    assert found.gated.identification is not None
    assert not found.gated.identification.accepted
    assert found.named == ()


def test_a_right_run_is_reported_as_before() -> None:
    machine = document()
    run, measurement = sent()
    gated = identify_gated(machine, [run], [measurement], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert with_named_conventions(machine, [run], [measurement], gated) == ConventionVerdict(gated)


def test_a_factor_on_all_amplitudes_is_named_where_the_unbalances_would_be_implausible() -> None:
    large = told(document(), sent(WrongConvention("", "", amplitude=1e3))).gated.identification
    small = told(document(), sent(WrongConvention("", "", amplitude=1e-3))).gated.identification
    assert large is not None
    assert small is not None
    assert large.accepted
    assert (
        "the document states G 2.9e+03: amplitudes in mm that were sent as m or amplitudes in µm that were sent"
        in large.verdict
    )
    assert "amplitudes in mm that were sent as µm or amplitudes in m that were sent as mm?" in small.verdict
    # Twice the amplitudes are twice the unbalances, which nobody can tell from the run.
    twice = told(document(), sent(WrongConvention("", "", amplitude=2.0)))
    assert twice.gated.identification is not None
    assert "amplitudes" not in twice.gated.identification.verdict
    assert twice.named == ()


@pytest.mark.long
@pytest.mark.parametrize(
    ("factor", "words"),
    [
        (0.5, "0-to-peak amplitudes that were sent as peak-to-peak"),
        (25.4, "amplitudes in"),
    ],
)
def test_with_known_weights_any_factor_on_the_amplitudes_is_named(factor: float, words: str) -> None:
    machine = chapter_3()
    discs = len(machine.discs)
    added = np.zeros(discs, dtype=complex)
    added[0] = 0.012
    seconds, speed, _ = right()
    seen = []
    for seed, weight in ((1, np.zeros(discs, dtype=complex)), (2, added)):
        clean = _with_weight(machine, speed, weight)
        run, measurement = recorded(seconds, speed, noisy(clean, seed=seed), machine.channels)
        wrong = WrongConvention("", "", amplitude=factor)
        seen.append((wrong.run(run), wrong.measurement(measurement).with_trial_weight(weight)))
    found = told(machine, *seen)
    assert found.named
    assert found.named[0].convention.words.startswith(words)
    assert found.named[0].convention.amplitude == pytest.approx(1.0 / factor)


def _with_weight(machine: Machine, speed: Floats, added: Complexes) -> Complexes:
    """Phasors of the train whose first disc carries a known unbalance beside its own."""
    discs = []
    for disc, extra in zip(machine.discs, added, strict=True):
        assert disc.unbalance is not None
        own = disc.unbalance.magnitude * np.exp(1j * math.radians(disc.unbalance.angle_deg)) + extra
        discs.append(
            disc.model_copy(
                update={
                    "unbalance": disc.unbalance.model_copy(
                        update={"magnitude": abs(own), "angle_deg": math.degrees(np.angle(own))}
                    )
                }
            )
        )
    return dense_response(machine.model_copy(update={"discs": tuple(discs)}), speed, direction=1)


@pytest.mark.long
def test_two_swapped_probes_are_named_although_films_bend_to_them() -> None:
    written = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    machine, rng = parse_machine(copy.deepcopy(written)), np.random.default_rng(0)
    described = parse_machine(perturbed(written, seed=0, span=0.3) | {"discs": copy.deepcopy(written["discs"])})
    seconds, speed = speed_law(machine, "run-down", duration=6000.0, samples=120)
    phasor = measured_phasors(machine, draw_truth(machine, rng), speed, rng)
    swapped = WrongConvention("", "", order=(0, 1, 2, 3, 6, 5, 4, 7))
    run, measurement = recorded(seconds, speed, phasor, machine.channels)
    found = told(described, (swapped.run(run), swapped.measurement(measurement)))
    assert swapped.order in [one.convention.order for one in found.named]
    assert found.named[0].accepted
