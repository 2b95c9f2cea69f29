"""Field balancing of the Chapter 3 train: runs of the dense model, which shares no code with the influence coefficients."""

from typing import Any

import numpy as np
import pytest

from estimator.arrays import Complexes, Floats
from estimator.balancing.balance_quality import RotorBalance
from estimator.balancing.balancing_check import check_balancing, limit_verdict
from estimator.balancing.field_balancing import BalancingOptions, BalancingRun, balance_from_trials
from estimator.balancing.trial_runs import TrialsUnusable
from estimator.balancing.vectors_at_speeds import NoCommonSpeed
from estimator.balancing.weight_places import WeightPlaces
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from tests.estimator.trains import chapter_3_document, dense_response, mirrored, noisy

SPEED = np.linspace(160.0, 100.0, 40)
DISCS = ("D1", "D2", "D3", "D4")


def document(*, turned: bool = False) -> dict[str, Any]:
    found = chapter_3_document()
    for disc in found["discs"]:
        disc["unbalance"]["magnitude"] *= 0.02
    return mirrored(found) if turned else found


def run_of(
    said: dict[str, Any], name: str, added: dict[str, complex], *, seed: int = 0, speed: Floats = SPEED
) -> BalancingRun:
    """A run with weights on, as the dense model and noise of 1 % show it."""
    loaded = {**said, "discs": [dict(disc) for disc in said["discs"]]}
    whole = np.zeros(len(DISCS), dtype=complex)
    for disc in loaded["discs"]:
        own = disc["unbalance"]
        total = own["magnitude"] * np.exp(1j * np.radians(own["angle_deg"])) + added.get(disc["id"], 0.0)
        disc["unbalance"] = {"magnitude": float(abs(total)), "angle_deg": float(np.degrees(np.angle(total)))}
        whole[DISCS.index(disc["id"])] = added.get(disc["id"], 0.0)
    machine = parse_machine(loaded)
    phasor: Complexes = noisy(dense_response(machine, speed, direction=machine.direction), seed=seed)
    measured = Measurement.of(speed=speed, phasor=phasor, direction=machine.direction)
    return BalancingRun(name, measured.with_trial_weight(whole) if added else measured)


TRIALS: dict[str, complex] = {"D1": 1e-4 + 0j, "D2": 1e-4j, "D3": -1e-4 + 0j, "D4": -1e-4j}


def runs(said: dict[str, Any]) -> tuple[list[BalancingRun], list[BalancingRun]]:
    trials = [
        run_of(said, f"trial {disc}", {disc: weight}, seed=number) for number, (disc, weight) in enumerate(TRIALS.items(), 2)
    ]
    return [run_of(said, "initial", {}, seed=1)], trials


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_a_correction_takes_the_unbalance_away_and_the_check_run_keeps_the_promise(turned: bool) -> None:
    said = document(turned=turned)
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, trials)
    own = np.array(
        [one["magnitude"] * np.exp(1j * np.radians(one["angle_deg"])) for one in (disc["unbalance"] for disc in said["discs"])]
    )
    assert found.separation.planes == DISCS
    assert np.max(np.abs(found.unbalance + own)) < 0.15 * np.max(np.abs(own))
    put_on = dict(zip(DISCS, found.unbalance.tolist(), strict=True))
    check = check_balancing(found, run_of(said, "check", put_on, seed=9))
    shown = np.isfinite(check.vector)
    assert np.mean(check.held[shown]) > 0.85
    assert np.nanmax(np.abs(check.vector)) < 0.3 * np.nanmax(np.abs(found.correction.before.value))
    grades = [(before.grade, after.grade) for before, after in zip(found.before, found.after, strict=True)]
    assert all(after < 0.2 * before for before, after in grades)
    measured = [plane for rotor in check.residual for plane in rotor.planes]
    true_left = own + found.unbalance
    assert max(abs(one.unbalance) for one in measured) < 5 * np.max(np.abs(true_left)) + 1e-6


def test_what_is_promised_is_what_nine_of_ten_check_runs_keep() -> None:
    """Ten calibrations with noise of their own: 95 % of the points, and none is promised less than it shows by chance."""
    said = document()
    machine = parse_machine(said)
    held = []
    for number in range(10):
        initial = [run_of(said, "initial", {}, seed=100 * number + 1)]
        trials = [
            run_of(said, f"trial {disc}", {disc: weight}, seed=100 * number + 2 + at)
            for at, (disc, weight) in enumerate(TRIALS.items())
        ]
        found = balance_from_trials(machine, initial, trials)
        put_on = dict(zip(DISCS, found.unbalance.tolist(), strict=True))
        check = run_of(said, "check", put_on, seed=100 * number + 50)
        held.append(np.mean(np.abs(check_balancing(found, check).vector) <= found.correction.after.upper))
    assert np.mean(held) > 0.9


def test_limits_and_holes_are_kept_and_the_prediction_is_that_of_what_is_put_on() -> None:
    said = document()
    initial, trials = runs(said)
    places = {"D1": WeightPlaces.evenly(12, radius=0.05, step=1e-4)}
    options = BalancingOptions(limit={"D2": 3e-5}, places=places, planes=("D1", "D2"), criterion="min-max")
    found = balance_from_trials(parse_machine(said), initial, trials, options=options)
    assert abs(found.unbalance[1]) <= 3e-5 * (1 + 1e-6)
    split = found.splits["D1"]
    assert found.unbalance[0] == pytest.approx(split.unbalance)
    assert split.masses / 1e-4 == pytest.approx(np.round(split.masses / 1e-4))
    assert found.separation.planes == ("D1", "D2")


def test_a_check_run_renews_the_correction() -> None:
    said = document()
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, trials, options=BalancingOptions(planes=("D1", "D3")))
    wrong = dict(zip(("D1", "D3"), (1.5 * found.unbalance).tolist(), strict=True))
    check = check_balancing(found, run_of(said, "check", wrong, seed=9))
    assert check.trim == pytest.approx(-0.5 * found.unbalance, rel=0.3)
    assert limit_verdict(check.after_trim, 1.0) == "met"
    assert limit_verdict(check.after_trim, 1e-12) == "not met"


def test_nothing_to_trim_is_exactly_nothing() -> None:
    """A check run that shows what was predicted, to rounding: no further weight, not one of 1e-12 g mm at some angle."""
    said = document()
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, trials, options=BalancingOptions(limit={"D1": 1e-6}))
    check = check_balancing(found, run_of(said, "check", dict(zip(DISCS, found.unbalance.tolist(), strict=True)), seed=9))
    assert check.trim[0] == 0.0 or abs(check.trim[0]) > 1e-12
    assert np.count_nonzero(check.trim) >= 3


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"added": {}}, "trial states no trial weight"),
        ({"added": {"D1": 48.0 + 0j}}, r"48 kg m on D1 would move the centre of mass .* 48 g mm are 4.8e-05 kg m"),
    ],
)
def test_wrong_trial_weights_are_named(changed: dict[str, Any], message: str) -> None:
    said = document()
    run = run_of(said, "trial", {"D1": 1e-4 + 0j})
    machine = parse_machine(said)
    added = np.zeros(4, dtype=complex)
    for disc, weight in changed["added"].items():
        added[DISCS.index(disc)] = weight
    wrong = BalancingRun("trial", run.measurement.with_trial_weight(added))
    with pytest.raises(TrialsUnusable, match=message):
        balance_from_trials(machine, [run_of(said, "initial", {}, seed=1)], [wrong])


def test_a_run_against_the_documents_rotation_is_named() -> None:
    said = document()
    _, trials = runs(said)
    turned = Measurement.of(speed=SPEED, phasor=trials[0].measurement.phasor, direction=-1.0)
    with pytest.raises(TrialsUnusable, match="initial turned against the rotation of the document, which is positive"):
        balance_from_trials(parse_machine(said), [BalancingRun("initial", turned)], trials)


def test_a_weight_that_shows_nothing_is_named() -> None:
    said = document()
    added = np.array([1e-10, 0, 0, 0], dtype=complex)
    weak = BalancingRun("trial", run_of(said, "trial", {}, seed=5).measurement.with_trial_weight(added))
    with pytest.raises(TrialsUnusable, match="D1 does nothing at the measuring points"):
        balance_from_trials(parse_machine(said), [run_of(said, "initial", {}, seed=1)], [weak])


def test_runs_without_a_common_speed_and_speeds_outside_the_range_are_named() -> None:
    said = document()
    initial, _ = runs(said)
    machine: Machine = parse_machine(said)
    elsewhere = run_of(said, "trial", {"D1": 1e-4 + 0j}, speed=np.linspace(300.0, 250.0, 20))
    with pytest.raises(NoCommonSpeed, match="the runs have no speed in common between 90 and 6000 r/min"):
        balance_from_trials(machine, initial, [elsewhere])
    with pytest.raises(TrialsUnusable, match="7000 r/min lies outside the document's range, 90 to 6000 r/min"):
        balance_from_trials(machine, initial, [elsewhere], options=BalancingOptions(speed=np.array([7000 * np.pi / 30])))


def residual_verdicts(found: tuple[RotorBalance, ...]) -> dict[str, str]:
    return {plane.bearing: plane.iso for rotor in found for plane in rotor.planes}


def test_the_residual_unbalance_of_a_disc_without_a_trial_run_is_not_known() -> None:
    """It was met with 0 g mm by construction: of the 120 g mm on D2 nobody had measured anything."""
    said = document()
    initial, trials = runs(said)
    tried = [run for run in trials if run.name != "trial D2"]
    options = BalancingOptions(grade=40.0)
    found = balance_from_trials(parse_machine(said), initial, tried, options=options)
    check = check_balancing(found, run_of(said, "check", dict(zip(found.separation.planes, found.unbalance, strict=True))))
    for state in (found.before, found.after, check.residual):
        verdicts = residual_verdicts(state)
        assert verdicts["B1"] == verdicts["B2"] == "not known"
        assert "met" not in verdicts.values(), "what D2 does counts in the other rotor, too"
        assert state[0].planes[0].untold == "plane D2 had no trial run"
    whole = balance_from_trials(parse_machine(said), initial, trials, options=options)
    assert set(residual_verdicts(whole.after).values()) == {"met"}


def test_the_residual_unbalance_of_a_plane_that_is_left_out_is_not_known() -> None:
    """A weight on D1 that is said to be on D2 does what one on D1 does."""
    said = document()
    initial, trials = runs(said)
    beside = run_of(said, "beside", {"D1": 0.9e-4 + 0j}, seed=7)
    wrong = BalancingRun("beside", beside.measurement.with_trial_weight(np.array([0, 0.9e-4, 0, 0], dtype=complex)))
    found = balance_from_trials(
        parse_machine(said), initial, [trials[0], wrong, *trials[2:]], options=BalancingOptions(grade=40.0)
    )
    (left_out,) = found.separation.left_out
    assert found.after[0].planes[0].untold == f"plane {left_out} cannot be told apart from others, or from the scatter"
    assert "met" not in residual_verdicts(found.after).values()


def heavier(run: BalancingRun, factor: float) -> BalancingRun:
    """The same run, with its weights stated in a unit that is larger by a factor."""
    assert run.added is not None
    return BalancingRun(run.name, run.measurement.with_trial_weight(factor * run.added))


@pytest.mark.parametrize(
    ("factor", "message"),
    [
        (1e6, r"100 kg m on D1 would move the centre of mass of its rotor, .* in another unit\? 100 g mm are 0.0001 kg m"),
        (1e3, r"0.1 kg m on D1 would move .* by 1\d.* mm; is it in another unit\? 0.1 kg mm \(100 g mm\) are 0.0001 kg m"),
    ],
)
def test_a_trial_weight_is_judged_by_the_rotor_that_bears_it(factor: float, message: str) -> None:
    """The mass of the whole train let pass what no single rotor bears."""
    said = document()
    initial, trials = runs(said)
    with pytest.raises(TrialsUnusable, match=message):
        balance_from_trials(parse_machine(said), initial, [heavier(trials[0], factor), *trials[1:]])


def test_a_correction_that_no_running_rotor_needs_is_doubted() -> None:
    """Trial weights in g in that were said to be in the next larger unit pass alone; what they lead to does not."""
    said = document()
    for disc in said["discs"]:
        disc["unbalance"]["magnitude"] *= 3.0
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, [heavier(run, 25.4) for run in trials])
    doubts = [one for one in found.notes if "is the trial weights' unit right?" in one]
    assert doubts
    amount = float(f"{1e6 * abs(found.unbalance[0]):.4g}")
    assert doubts[0].startswith(f"{amount:.12g} g mm on {found.separation.planes[0]} would be G ")
    usual = balance_from_trials(parse_machine(said), initial, trials)
    assert not any("unit" in one for one in usual.notes)


def test_a_trial_weight_that_is_stated_far_too_small_is_doubted() -> None:
    said = document()
    initial, trials = runs(said)
    found = balance_from_trials(parse_machine(said), initial, [heavier(run, 1e-3 / 25.4) for run in trials])
    doubts = [one for one in found.notes if "were they heavier, or in a larger unit?" in one]
    assert len(doubts) == 4


def test_a_check_run_as_promised_has_nothing_to_trim() -> None:
    """Trims of 27, 24, 9 and 17 g mm were proposed, of which the runs know nothing: 95 % of 20 such check runs have none."""
    said = document()
    machine = parse_machine(said)
    initial, trials = runs(said)
    found = balance_from_trials(machine, initial, trials)
    own = [
        one["magnitude"] * np.exp(1j * np.radians(one["angle_deg"])) for one in (disc["unbalance"] for disc in said["discs"])
    ]
    rightly = dict(zip(DISCS, (-np.array(own)).tolist(), strict=True))
    noise = [check_balancing(found, run_of(said, "check", rightly, seed=50 + number)).is_trim_noise for number in range(20)]
    assert sum(noise) >= 17
    wrong = dict(zip(DISCS, (1.5 * found.unbalance).tolist(), strict=True))
    check = check_balancing(found, run_of(said, "check", wrong, seed=9))
    assert not check.is_trim_noise
    assert np.all(check.trim_band.lower <= np.abs(check.trim))
    assert np.all(np.abs(check.trim) <= check.trim_band.upper)


def test_a_check_run_with_weights_on_a_disc_that_was_left_out_is_predicted_by_its_trial() -> None:
    said = document()
    initial, trials = runs(said)
    options = BalancingOptions(planes=("D1", "D3"))
    found = balance_from_trials(parse_machine(said), initial, trials, options=options)
    put_on = {"D1": 4e-5 + 0j, "D3": 0.0j, "D4": 6e-5j}
    check = check_balancing(found, run_of(said, "check", put_on, seed=9))
    assert check.predicted is not None
    assert check.unpredicted == ()
    assert check.beside == {"D4": pytest.approx(6e-5j)}
    assert np.mean(check.held[np.isfinite(check.vector)]) > 0.85


def test_a_check_run_with_weights_on_a_disc_without_a_trial_tells_what_it_can() -> None:
    """Nothing was told at all. What was on D2 stays there: the trim is of the vibration with it."""
    said = document()
    initial, trials = runs(said)
    tried = [run for run in trials if run.name != "trial D2"]
    found = balance_from_trials(parse_machine(said), initial, tried)
    bare = dict(zip(found.separation.planes, found.unbalance.tolist(), strict=True))
    check = check_balancing(found, run_of(said, "check", bare | {"D2": -1e-4 + 0j}, seed=9))
    assert check.predicted is None
    assert check.unpredicted == ("D2",)
    assert not np.any(check.held)
    again = {plane: bare[plane] + one for plane, one in zip(found.separation.planes, check.trim.tolist(), strict=True)}
    trimmed = run_of(said, "trimmed", again | {"D2": -1e-4 + 0j}, seed=10)
    assert np.linalg.norm(check_balancing(found, trimmed).vector) < np.linalg.norm(check.vector)
