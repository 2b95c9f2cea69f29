"""Identification behind the gate: coast-downs, steady runs, wrong clocks, too little left."""

from functools import cache

import numpy as np
from msgspec.structs import replace

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.identification.quality_gate import identify_gated
from estimator.machine.document import Machine, parse_machine
from estimator.machine.rules import QualityRules
from estimator.phasors.measurement import Measurement
from estimator.phasors.quality import Flag
from estimator.phasors.recorded_run import RecordedRun
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import unknowns
from estimator.simulation.coast_down import coast_down
from tests.estimator.sweeps import fast_coast_down, light_chapter_3, linear_law, noisy, recorded, steady
from tests.estimator.trains import chapter_3_document

ONE = Options(starts=1)


def held(found: Identification, machine: Machine) -> float:
    """Part of the coefficients' 95 % intervals that hold the truth."""
    truth: dict[str, float] = {}
    for kind, parts in (("bearing", machine.bearings), ("coupling", machine.couplings)):
        for part in parts:
            truth |= {f"{kind}.{part.id}.{name}": value for name, value in part.model_dump().items()}
    inside = [
        one.lower <= truth[one.name] <= one.upper
        for one in found.estimates
        if one.name in truth and one.lower is not None and one.upper is not None
    ]
    return float(np.mean(inside))


@cache
def swept(seed: int) -> tuple[RecordedRun, Measurement]:
    """The coast-down at 50 rpm/s, 250 samples."""
    moved = fast_coast_down()
    time = np.linspace(5.0, 100.0, 250)
    return recorded(time, moved.law.speed(time), noisy(moved.envelope(time), seed), light_chapter_3().channels)


def test_a_coast_down_is_identified_with_the_gate_and_not_without() -> None:
    machine = light_chapter_3()
    run, measurement = swept(1)
    without = identify(machine, measurement, ONE)
    assert not without.accepted
    assert held(without, machine) < 0.6
    gated = identify_gated(machine, [run], [measurement], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert held(gated.identification, machine) >= 0.85
    quality = gated.qualities[0]
    assert quality.counts["sweep-rate"] > 20
    assert quality.counts["corrected"] > 20
    assert any(words.startswith("sweep rate: the model predicts") for words in quality.findings)
    assert "left out for their quality" in gated.identification.verdict
    # What is left out lies around and behind the resonances, not everywhere.
    assert quality.usable.mean() > 0.6


def test_without_the_gate_everything_is_used_and_still_told() -> None:
    machine = light_chapter_3()
    run, measurement = swept(1)
    gated = identify_gated(machine, [run], [measurement], options=ONE, gate=False)
    assert gated.identification is not None
    assert gated.identification.samples == run.speed.size
    assert "quality" not in gated.identification.verdict
    assert gated.qualities[0].counts["sweep-rate"] > 20


def slow(machine: Machine, *, duration: float, seed: int = 3) -> tuple[RecordedRun, Measurement]:
    speed = np.linspace(576.0, 52.0, 150)
    phasor = noisy(steady(machine, speed), seed)
    return recorded(np.linspace(0.0, duration, 150), speed, phasor, machine.channels)


def test_a_slow_run_is_identified_as_if_there_were_no_gate() -> None:
    machine = light_chapter_3()
    run, measurement = slow(machine, duration=1e6)
    gated = identify_gated(machine, [run], [measurement], options=ONE)
    plain = identify(machine, measurement, ONE)
    assert gated.identification is not None
    error = np.sqrt(np.diag(plain.covariance))
    assert np.all(np.abs(gated.identification.point - plain.point) < 0.2 * error)
    assert gated.qualities[0].usable.all()
    assert gated.qualities[0].words == ""


def test_steady_phasors_with_the_times_of_a_fast_sweep_are_believed_over_the_clock() -> None:
    machine = light_chapter_3()
    run, measurement = slow(machine, duration=60.0)
    gated = identify_gated(machine, [run], [measurement], options=ONE)
    plain = identify(machine, measurement, ONE)
    assert gated.identification is not None
    error = np.sqrt(np.diag(plain.covariance))
    assert np.all(np.abs(gated.identification.point - plain.point) < 0.2 * error)
    assert gated.qualities[0].usable.all()
    assert any("the times are not those of the measurement" in words for words in gated.qualities[0].findings)


def test_a_run_in_the_other_sense_of_rotation_is_judged_in_its_own_sense() -> None:
    machine = light_chapter_3()
    other = machine.model_copy(update={"rotation": "negative"})
    speed = np.linspace(576.0, 52.0, 150)
    run, measurement = recorded(np.linspace(0.0, 600.0, 150), speed, noisy(steady(other, speed), 3), machine.channels)
    against = replace(measurement, direction=-measurement.direction)
    gated = identify_gated(machine, [run], [against], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert held(gated.identification, machine) >= 0.85
    assert gated.qualities[0].counts == {}
    assert any("the data say that they do not" in words for words in gated.qualities[0].findings)


def test_a_trial_weight_rings_too() -> None:
    machine = light_chapter_3()
    weight = np.array([0.05j, 0.0, 0.0, 0.0])  # five times what the disc has
    own = np.array([one.nominal or 0.0 for one in unknowns(machine, assemble_rotor(machine)).excitations])
    law = linear_law(first=576.0, last=52.0, duration=100.0)
    moved = coast_down(machine, law, step=8e-3, excitations=own + weight)
    time = np.linspace(5.0, 100.0, 250)
    run, measurement = recorded(time, law.speed(time), noisy(moved.envelope(time), 2), machine.channels)
    gated = identify_gated(machine, [run], [measurement.with_trial_weight(weight)], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert held(gated.identification, machine) >= 0.85


def test_a_fit_that_explains_nothing_does_not_doubt_the_times() -> None:
    machine = light_chapter_3()
    speed = np.linspace(576.0, 52.0, 150)
    # Gains that follow the speed, which the model does not know.
    strange = steady(machine, speed) * (1.0 + 0.05 * np.sin(speed[:, None] / 200.0 + np.arange(8)))
    run, measurement = recorded(np.linspace(0.0, 60.0, 150), speed, noisy(strange, 3), machine.channels)
    gated = identify_gated(machine, [run], [measurement], options=ONE)
    assert gated.identification is not None
    assert not gated.identification.accepted
    told = " ".join(gated.qualities[0].findings)
    assert "no fit explains the data" in told
    assert "the times are not those" not in told


def test_a_gate_that_leaves_too_little_says_so() -> None:
    machine = light_chapter_3()
    run, measurement = slow(machine, duration=1e6)
    gated = identify_gated(machine, [run], [measurement], rules=QualityRules(accepted_rpm=(1000.0, 1010.0)))
    assert gated.identification is None
    assert gated.error is not None
    assert "cannot determine 50 unknowns" in gated.error
    assert "not-accepted" in gated.error
    assert any(words.startswith("too few usable points") for words in gated.qualities[0].findings)


def test_a_run_without_times_is_judged_by_its_beats_alone() -> None:
    machine = light_chapter_3()
    run, measurement = swept(1)
    no_clock = RecordedRun(None, run.speed, run.phasor, run.status, run.scatter, run.channels)
    gated = identify_gated(machine, [no_clock], [measurement], options=ONE)
    assert "sweep-rate" not in gated.qualities[0].counts


def test_several_runs_are_judged_each_by_itself_and_fitted_together() -> None:
    machine = light_chapter_3()
    pairs = [swept(1), slow(machine, duration=1e6)]
    gated = identify_gated(machine, [run for run, _ in pairs], [measured for _, measured in pairs], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert gated.qualities[0].counts["sweep-rate"] > 20
    assert gated.qualities[1].counts.get("sweep-rate", 0) == 0
    assert gated.qualities[1].flags.shape == pairs[1][0].phasor.shape


def test_where_the_document_states_no_noise_the_data_s_own_is_used() -> None:
    document = chapter_3_document()
    del document["noise"]
    silent = parse_machine(document)
    speed = np.linspace(576.0, 52.0, 300)
    phasor = noisy(steady(silent, speed), 5, 0.04)
    run, measurement = recorded(np.linspace(0.0, 1e6, 300), speed, phasor, silent.channels)
    assert not identify(silent, measurement, ONE).accepted  # by the default of 1 %
    gated = identify_gated(silent, [run], [measurement], options=ONE)
    assert gated.identification is not None
    assert gated.identification.accepted
    assert 0.6 < gated.identification.chi_square / gated.identification.degrees_of_freedom < 1.2
    assert held(gated.identification, silent) > 0.85
    assert not gated.qualities[0].flags.any() or set(gated.qualities[0].counts) <= {Flag.CORRECTED.label}
