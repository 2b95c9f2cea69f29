"""The simulated fleets: their truth against what is asked of it, the scores against hand-made alerts, and the short report."""

import math
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.fleet.amount import (
    PRINTED_RISE,
    RIG,
    case_a1,
    case_a1_least_squares,
    example,
    growth_for,
    misaligned_elements,
    rises,
)
from benchmarks.fleet.histories import (
    DAMPING,
    SEASON,
    WEEKS_A_YEAR,
    BearingChanged,
    GainDrifted,
    History,
    MachineChange,
    Misaligned,
    OutliersBegan,
    ProbeLost,
    RunOutChanged,
    Season,
    Seasonality,
    UnbalanceChanged,
    history,
)
from benchmarks.fleet.judging import Standing, judged, opened
from benchmarks.fleet.measuring import Ordered, measured
from benchmarks.fleet.report import main, part_interval, rate_bound
from benchmarks.fleet.scenarios import SCENARIOS, SHORT_BASELINE
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.machine.rules import Noise

SMALL = "thesis-chapter-3"


def truths(*changes: MachineChange, weeks: int = 12, seasonality: Seasonality = "none", seed: int = 1) -> History:
    rng = np.random.default_rng(seed)
    return history(example(SMALL), changes, weeks=weeks, baseline=5, seasonality=seasonality, rng=rng)


def coefficients(one: History) -> np.ndarray:
    return np.array([state.truth.coefficients for state in one.states])


def noiseless(machine: Machine) -> Machine:
    return machine.model_copy(update={"noise": Noise(relative=1e-9, floor=0.0)})


def test_case_a1_is_the_mean_rise_that_the_thesis_prints() -> None:
    rig = example(RIG)
    assert np.mean(rises(rig, rig.couplings[0], case_a1())) == pytest.approx(np.mean(PRINTED_RISE), rel=1e-4)
    # No coefficient of the thesis's rig grew by more than 12 % in this case (§5.7).
    assert 0.04 < case_a1_least_squares() < case_a1() < 0.12


@pytest.mark.parametrize("mode", [1, 2])
def test_the_growth_for_one_mode_gives_its_printed_rise(mode: int) -> None:
    rig = example(RIG)
    assert rises(rig, rig.couplings[0], growth_for(mode))[mode] == pytest.approx(PRINTED_RISE[mode], rel=1e-4)


def test_the_second_coupling_of_a_train_stiffens_its_own_neighbours() -> None:
    train = example("turbine-compressor-generator")
    assert misaligned_elements(train, train.couplings[1]) == ("coupling.C2", "bearing.B4", "bearing.B5")


def test_the_run_to_run_scatter_is_as_asked() -> None:
    many = truths(weeks=400)
    scatter = np.std(np.log(np.abs(coefficients(many))), axis=0)
    damping = np.array([one.quantity in DAMPING for one in many.states[0].truth.unknowns.coefficients])
    # 400 weeks know a standard deviation to 3.5 %: four times that.
    assert scatter[~damping] == pytest.approx(0.01, rel=0.15)
    assert scatter[damping] == pytest.approx(0.05, rel=0.15)
    together = np.corrcoef(np.log(np.abs(coefficients(many))).T)
    assert np.max(np.abs(together - np.eye(len(scatter)))) < 0.25


def test_a_season_moves_stiffnesses_by_two_per_cent_and_no_damping() -> None:
    known = truths().states[0].truth.unknowns.coefficients
    damping = np.array([one.quantity in DAMPING for one in known])
    year = np.array([Season.draw(known, "together", np.random.default_rng(2)).at(week) for week in range(WEEKS_A_YEAR)])
    assert np.log(year).max(axis=0)[~damping] == pytest.approx(SEASON, rel=0.01)
    assert np.ptp(year[:, ~damping], axis=1) == pytest.approx(0.0, abs=1e-15)
    assert np.all(year[:, damping] == 1.0)
    apart = np.array([Season.draw(known, "apart", np.random.default_rng(2)).at(week) for week in range(WEEKS_A_YEAR)])
    assert np.abs(np.log(apart)).max() <= SEASON
    first = [one.element == "bearing.B1" for one in known]
    assert np.ptp(apart[:, first & ~damping], axis=1) == pytest.approx(0.0, abs=1e-15)
    assert len(np.unique(np.round(apart[0, ~damping], 12))) == 5


def test_changes_change_what_they_name_and_nothing_else() -> None:
    grown = ("coupling.C1", "bearing.B2", "bearing.B3")
    before, after = truths(), truths(Misaligned("coupling.C1", 6, 0, 0.08, grown), BearingChanged("bearing.B4", 8, 0, -0.2))
    part = coefficients(after) / coefficients(before)
    elements = np.array([one.element for one in before.states[0].truth.unknowns.coefficients])
    assert np.all(part[:6] == 1.0)
    assert part[6:, np.isin(elements, grown)] == pytest.approx(1.08)
    assert part[8:, elements == "bearing.B4"] == pytest.approx(0.8)
    assert np.all(part[:, elements == "bearing.B1"] == 1.0)
    turned = truths(UnbalanceChanged("disc.D2", 6, 0, 0.5j))
    ratio = turned.states[7].truth.unbalances / before.states[7].truth.unbalances
    assert ratio == pytest.approx([1.0, 1.0 + 0.5j, 1.0, 1.0])


def test_a_drift_grows_evenly_to_its_full_size() -> None:
    drifting = truths(GainDrifted("probe.B1X", 4, 4, 0, 0.1))
    gain = [state.gain[0].real for state in drifting.states]
    assert gain[:9] == pytest.approx([1.0, 1.0, 1.0, 1.0, 1.025, 1.05, 1.075, 1.1, 1.1])


def test_channels_show_their_gain_and_run_out_and_lost_ones_nothing() -> None:
    changes = (
        GainDrifted("probe.B1X", 1, 0, 0, 0.1),
        RunOutChanged("probe.B1Y", 1, 0, 1, 2e-3j),
        ProbeLost("probe.B2X", 1, 0, 2),
    )
    machine, state = noiseless(example(SMALL)), truths(*changes).states[2]
    well = replace(state, gain=np.ones(8, dtype=complex), run_out=np.zeros(8, dtype=complex), lost=np.zeros(8, dtype=bool))
    shown, clean = (measured(machine, one, np.random.default_rng(3)) for one in (state, well))
    assert shown.phasor[:, 0] == pytest.approx(1.1 * clean.phasor[:, 0], rel=1e-6)
    assert shown.phasor[:, 1] == pytest.approx(clean.phasor[:, 1] + 2e-3j, rel=1e-6)
    assert not shown.usable[:, 2].any()
    assert shown.usable[:, [0, 1, 3, 4, 5, 6, 7]].all()


def test_five_per_cent_outliers_are_off_by_a_fifth_at_least() -> None:
    machine = noiseless(example(SMALL))
    state = truths(OutliersBegan("machine", 0, 0, 0.05)).states[0]
    off = []
    for seed in range(20):
        spoilt, clean = (
            measured(machine, replace(state, outlier_part=part), np.random.default_rng(seed)).phasor for part in (0.05, 0.0)
        )
        off.append(np.abs(spoilt / clean - 1.0))
    hit = np.array(off) > 1e-6
    assert np.array(off)[hit].min() >= 0.2 * (1.0 - 1e-6)
    assert np.mean(hit) == pytest.approx(0.05, abs=5 * math.sqrt(0.05 * 0.95 / hit.size))


def test_the_same_seed_makes_the_same_history_and_another_number_another() -> None:
    def drawn(number: int) -> np.ndarray:
        ordered = Ordered(SMALL, "all together", "apart", 5, number)
        return coefficients(
            SCENARIOS["all together"].history(example(SMALL), seed=ordered.seeds, seasonality="apart", watched=6)
        )

    assert np.array_equal(drawn(0), drawn(0))
    assert not np.array_equal(drawn(0), drawn(1))


def test_all_together_spoils_two_different_probes_behind_a_short_baseline() -> None:
    for number in range(20):
        one = SCENARIOS["all together"].history(example(SMALL), seed=(number,), seasonality="apart", watched=10)
        kinds = [change.kind for change in one.changes]
        assert sorted(kinds) == ["outliers", "sensor", "sensor", "unbalance"]
        assert len({change.element for change in one.changes}) == 4
        assert one.baseline == SHORT_BASELINE
        assert min(change.onset for change in one.changes) >= SHORT_BASELINE


@pytest.mark.parametrize("scenario", ["healthy", "outliers"])
def test_a_fit_from_the_first_ones_end_is_the_fit_from_the_document(scenario: str) -> None:
    """This lets a fleet's fits start there: the same minimum, outliers or not."""
    machine = example(SMALL)
    changes = () if scenario == "healthy" else (OutliersBegan("machine", 0, 0, 0.05),)
    rng = np.random.default_rng(4)
    first, *others = (measured(machine, state, rng) for state in truths(*changes, weeks=4).states)
    begun = identify(machine, first)
    for measurement in others:
        cold, warm = identify(machine, measurement), identify(machine, measurement, beginning=begun.point)
        assert cold.accepted
        assert warm.accepted
        assert warm.outliers == cold.outliers
        assert np.max(np.abs(warm.point - cold.point) / np.sqrt(np.diag(cold.covariance))) < 0.05


def test_openings_are_scored_against_what_befell_the_machine() -> None:
    drift = truths(Misaligned("coupling.C1", 6, 4, 0.08, ("coupling.C1",)))
    right, wrong = ("misalignment", "coupling.C1"), ("unbalance", "disc.D1")
    nothing: frozenset[tuple[str, str]] = frozenset()
    standing: Standing = tuple(
        frozenset({right}) if week in (5, 8, 9, 11) else frozenset({wrong}) if week == 7 else nothing for week in range(12)
    )
    assert [(one.week, one.named) for one in opened(standing)] == [(5, right), (7, wrong), (8, right), (11, right)]
    outcome = judged(drift, standing)
    assert outcome.false_misalignments == 1  # week 5, before anything had happened
    assert [one.week for one in outcome.wrong] == [5, 7]
    assert outcome.named == (wrong,)
    assert outcome.right == (True,)
    assert outcome.runs == (3,)
    assert outcome.part == (0.75,)
    assert outcome.years == pytest.approx(7 / 52)
    silent = judged(drift, (nothing,) * 12)
    assert (silent.named, silent.right, silent.runs, silent.part) == ((None,), (False,), (None,), (None,))


def test_bounds_of_rates_and_parts_are_the_exact_ones() -> None:
    """Garwood: none in T, at most -ln 0.025 / T. Clopper and Pearson: n of n, at least 0.025^(1/n)."""
    assert rate_bound(0, 60.0) == pytest.approx(-math.log(0.025) / 60.0)
    low, high = part_interval(300, 300)
    assert low == pytest.approx(0.025 ** (1 / 300))
    assert high == 1.0
    # Of what the upper bound says, as few as were seen come in 2.5 %.
    bound = rate_bound(2, 1.0)
    assert math.exp(-bound) * (1 + bound + bound**2 / 2) == pytest.approx(0.025)


@pytest.mark.long
def test_the_short_report_prints_every_figure(capsys: pytest.CaptureFixture[str]) -> None:
    main(["--short", "--processes", "1", "--only", "unbalance step", "misalignment step"])
    page = capsys.readouterr().out
    assert page.startswith("6 machines")
    for figure in ("rise of natural frequencies", "false misalignment alerts", "detected within 3 runs", "drift to A1"):
        assert figure in page
    rows = [line.split() for line in page.splitlines() if line.startswith("misalignment step") and "%" in line]
    # The last of the power's rows and of the names' rows is over all machines.
    assert [row[row.index("all") + 2] for row in rows if "all" in row] == ["100.0", "100.0"]
    matrix = page[page.index("first alert after a") :].split()
    assert matrix[4:] == ["misalignment", "unbalance", "unbalance", "step", "0", "2", "misalignment", "step", "4", "0"]
