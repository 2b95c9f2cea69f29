"""The diagnosis: its evidence against the probability of the data, and the right name for what was done to a machine."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.arrays import Floats
from estimator.diagnosis.baseline_reference import Reference, reference
from estimator.diagnosis.bayes_factors import Deviation, diagnose
from estimator.diagnosis.hypotheses import Hypothesis
from estimator.diagnosis.observation import Observation
from tests.estimator.diagnosis import watched_machine as plant


def named(observations: tuple[Observation, ...]) -> set[tuple[str, str]]:
    found = diagnose(plant.watch().reference, observations)
    return {(one.kind, one.element) for one in found.causes}


def test_a_healthy_machine_has_nothing() -> None:
    for one in plant.healthy(4):
        assert named((one,)) == set()
    assert named(plant.healthy(4)) == set()


def test_each_cause_is_called_what_it_is() -> None:
    healthy = plant.true_machine()
    done = {
        ("misalignment", "coupling.C1"): plant.after(plant.misaligned(0.12)),
        ("bearing", "bearing.B1"): plant.after(plant.grown({"bearing.B1": 1.2}), count=1),
        ("bearing", "bearing.B2"): plant.after(plant.grown({"bearing.B2": 0.8}), count=1),
        ("unbalance", "disc.core-2"): plant.after(plant.grown({}, {1: 1.5}), count=1),
        ("sensor", "probe.B2L"): plant.after(healthy, count=1, edit=plant.gain(2, 1.12)),
        ("sensor", "probe.B3R"): plant.after(healthy, count=1, edit=plant.gain(5, 0.9)),
        ("run_out", "probe.B2L"): plant.after(healthy, count=1, edit=plant.run_out(2, 1e-6)),
    }
    assert {cause: named(observations) for cause, observations in done.items()} == {cause: {cause} for cause in done}


def test_two_causes_at_once_are_both_named() -> None:
    both = plant.grown({"coupling.C1": 1.2, "bearing.B2": 1.2, "bearing.B3": 1.2}, {0: 1.5j})
    assert named(plant.after(both)) == {("misalignment", "coupling.C1"), ("unbalance", "disc.core-1")}


@pytest.mark.parametrize(("channel", "factor"), [(2, 0.8), (3, 1.2), (6, 1.15)])
def test_a_probe_that_is_far_off_is_no_coupling(channel: int, factor: float) -> None:
    """Tests the second order of a gain, which looks like a change of the coupling."""
    probe = ("sensor", f"probe.{plant.motor_pump().channels[channel]}")
    seed = 5000 + 100 * channel
    assert named(plant.after(plant.true_machine(), seed=seed, edit=plant.gain(channel, factor))) == {probe}
    beside = plant.after(plant.misaligned(0.12), seed=seed, edit=plant.gain(channel, factor))
    assert named(beside) == {probe, ("misalignment", "coupling.C1")}


def test_a_large_unbalance_hides_no_misalignment() -> None:
    beside = dict.fromkeys(("coupling.C1", "bearing.B2", "bearing.B3"), 1.084)
    for times in (2.0, 3.0):
        runs = plant.after(plant.grown(beside, {0: times}))
        assert named(runs) == {("misalignment", "coupling.C1"), ("unbalance", "disc.core-1")}
        assert named(plant.after(plant.grown({}, {0: times}))) == {("unbalance", "disc.core-1")}


@pytest.mark.parametrize(("fitted", "kinds"), [(True, ["pedestal", "misalignment"]), (False, ["pedestal"])])
def test_a_softer_pedestal_hides_no_misalignment(*, fitted: bool, kinds: list[str]) -> None:
    """Each fit has what it moves as unknowns: of it nothing is left that would look like another cause."""
    named_first = Hypothesis("pedestal", "pedestal.P1", (np.array([[5.0], [0.0]]),), np.zeros((0, 2)), fitted=fitted)
    beside = Hypothesis("misalignment", "coupling.C1", (np.array([[0.0], [5.0]]),), np.zeros((0, 2)))
    nothing, names = np.zeros((2, 0)), ("pedestal.P1.kxx", "bearing.B1.elevation_y")
    healthy = Reference(names, np.zeros(2), np.ones(2), np.zeros(2), 1e-6 * np.eye(2), (named_first, beside), nothing, nothing)
    (seen,) = plant.healthy(1)
    run = replace(
        seen,
        names=names,
        coordinates=2,
        reference=np.array([14.9, 3.63]),
        gradient=np.zeros(2),
        information=1e6 * np.eye(2),
    )
    found = diagnose(healthy, [run])
    assert [one.kind for one in found.causes] == kinds
    assert 4.0 < found.evidence["misalignment", "coupling.C1"] < 0.05 * found.evidence["pedestal", "pedestal.P1"]


def test_one_cause_with_many_freedoms_hides_no_two_that_explain_more() -> None:
    """As the deviations of a worn bearing's film do beside a coupling that has moved: they explain most of both."""
    free, nothing = np.zeros((0, 7)), np.zeros((7, 0))
    film = Hypothesis("bearing", "bearing.B2", (5.0 * np.eye(7)[:, :6],), free)
    wear = Hypothesis("wear", "bearing.B2", (np.array([[4.0, 1.0, 2.0, 0.0, 0.0, 0.0, 4.0]]).T,), free)
    moved = Hypothesis("misalignment", "coupling.C1", (np.array([[1.0, 4.0, 0.0, 2.0, 0.0, 0.0, -4.0]]).T,), free)
    names = (*(f"films.B2.deviation_{number}" for number in range(6)), "bearing.B2.elevation_y")
    every = (film, wear, moved)
    healthy = Reference(names, np.zeros(7), np.ones(7), np.zeros(7), 1e-6 * np.eye(7), every, nothing, nothing)
    (seen,) = plant.healthy(1)
    run = replace(seen, names=names, coordinates=7, gradient=np.zeros(7), information=1e6 * np.eye(7))

    def kinds(change: list[float]) -> set[str]:
        return {one.kind for one in diagnose(healthy, [replace(run, reference=np.array(change))]).causes}

    assert kinds([7.5, 7.5, 3.0, 3.0, 0.0, 0.0, 0.0]) == {"wear", "misalignment"}
    assert kinds([7.5, -7.5, 3.0, -3.0, 0.0, 0.0, 0.0]) == {"bearing"}
    assert kinds([8.0, 2.0, 4.0, 0.0, 0.0, 0.0, 8.0]) == {"wear"}


def test_what_a_cause_has_moved_and_by_how_much() -> None:
    found = diagnose(plant.watch().reference, plant.after(plant.grown({}, {1: 1.5}), count=3))
    (cause,) = found.causes
    assert cause.names == ("disc.core-2.unbalance.real", "disc.core-2.unbalance.imaginary")
    true = 0.5 * plant.true_machine().unbalances[1]
    apart = cause.change - np.array([true.real, true.imag])
    # The baseline's own error counts too: within four standard errors of both, and not shrunk away.
    assert np.linalg.norm(apart) < 0.15 * abs(true)
    assert cause.distance > 10.0


def test_neither_the_order_of_the_runs_nor_of_the_baseline_matters() -> None:
    machine, watch = plant.motor_pump(), plant.watch()
    window = plant.after(plant.misaligned(0.12), count=3)
    forwards = diagnose(watch.reference, window)
    backwards = diagnose(reference(machine, watch.baseline[::-1]), window[::-1])
    for one, other in zip(forwards.causes, backwards.causes, strict=True):
        assert (one.kind, one.element) == (other.kind, other.element)
        assert one.evidence == pytest.approx(other.evidence, rel=1e-6)
        assert one.agreement == pytest.approx(other.agreement[::-1], rel=1e-5)


def test_evidence_is_the_ratio_of_two_gaussian_densities() -> None:
    """For full-rank information, against the densities of the window's estimate with and without the changes."""
    base = plant.watch().reference
    now = plant.healthy(1)[0]
    # Something is known of every direction, so that the estimate has a density.
    known = now.information + np.diag((3.0 * base.unit) ** -2.0)
    moved = now.reference + 2.0 * base.unit * np.sin(np.arange(base.unit.size))
    shifted = replace(now, reference=moved, information=known)
    deviation = Deviation.of(base, [shifted])
    white = known * np.outer(base.unit, base.unit)
    apart = (moved - base.origin) / base.unit + np.linalg.solve(white, base.unit * now.gradient) - base.centre
    spread = np.linalg.inv(white) + np.eye(base.unit.size) + base.doubt

    def log_density(covariance: Floats) -> float:
        return -0.5 * float(np.linalg.slogdet(covariance)[1] + apart @ np.linalg.solve(covariance, apart))

    simple = [one for one in base.hypotheses if one.kind in ("unbalance", "sensor", "run_out", "bow")]
    for one in simple:
        assert not len(one.rising)
        each = [columns / base.unit[:, None] for columns in one.variants]
        densities = [log_density(spread + columns @ columns.T) for columns in each]
        expected = np.logaddexp.reduce(densities) - np.log(len(densities)) - log_density(spread)
        assert deviation.evidence(one) == pytest.approx(expected, rel=1e-4, abs=1e-3)


def test_chance_seldom_makes_evidence() -> None:
    """Bayes factors are 1 on average while nothing has happened, so that e^t is exceeded at most once in e^t runs (Markov)."""
    base = plant.watch().reference
    now = plant.healthy(1)[0]
    found = Deviation.of(base, [now])
    root = np.linalg.cholesky(found.precision + 1e-10 * np.trace(found.precision) / len(found.pull) * np.eye(len(found.pull)))
    rng = np.random.default_rng(3)
    drawn = [replace(found, pull=root @ rng.standard_normal(len(found.pull)), _evidence={}) for _ in range(400)]
    for one in base.hypotheses:
        factors = np.array([np.exp(another.evidence(one)) for another in drawn])
        assert np.mean(factors >= 20.0) <= 1.0 / 20.0 + 3.0 * np.sqrt(0.05 / 400)


def test_unlike_identifications_are_not_compared() -> None:
    watch = plant.watch()
    other = replace(watch.baseline[0], names=("something", *watch.baseline[0].names[1:]))
    with pytest.raises(ValueError, match="are not of the baseline's quantities"):
        diagnose(watch.reference, [other])
    with pytest.raises(ValueError, match="of different quantities"):
        reference(plant.motor_pump(), [watch.baseline[0], other])
    with pytest.raises(ValueError, match="at least one identification"):
        reference(plant.motor_pump(), [])
