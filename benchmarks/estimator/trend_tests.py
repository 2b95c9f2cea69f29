"""False alarms of deviations, charts and rates with a small baseline, against those they state, and their detection delay.

Machines are drawn: their scatter from run to run from what is believed of it, their runs from that scatter and the fits'
errors. Everything behind that is the estimator's own.
"""

import argparse
import math
from collections.abc import Callable, Sequence

import numpy as np

from estimator.arrays import Floats
from estimator.machine.parameter_description import describe
from estimator.trends.between_run_scatter import PRIOR_WEIGHT, expected_scatter
from estimator.trends.control_charts import cusum, ewma
from estimator.trends.deviations import Whitening, deviations
from estimator.trends.parameter_vector import Point
from estimator.trends.rate_of_change import WINDOW
from estimator.trends.trend_tests import CUSUM_REFERENCE, EWMA_WEIGHT, RUN_LENGTH, DatedPoint, creep_limit, step_limit
from service.alerts.lifecycle import Severity
from service.monitoring.assessment.rate_of_change import rate_findings
from service.monitoring.rules.limits import Limits

TERMS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cyy")
NAMES = tuple(f"bearing.B{number}.{term}" for number in range(1, 5) for term in TERMS)
CENTRE = np.array([math.log(1e7), 1e6, -1e6, math.log(1e7), math.log(1e4), math.log(1e4)] * 4)
SIZE = np.array([1.0, 1e7, 1e7, 1.0, 1.0, 1.0] * 4)
CORRELATION = 0.5
"""Between the errors of one bearing's coefficients."""
BASELINES = (3, 5, 10)
CHANCES = (0.1, 0.01, 0.001)
SEASON = 0.02
"""Amplitude of the stiffnesses' yearly wave."""
YEAR = 52
WEEKS = 104
LONGEST_DELAY = 60
DRIFTS = (0.0025, 0.005, 0.0075, 0.01, 0.03)
"""Drifts of a stiffness, per week."""


class Drawn:
    """A machine that was drawn, and its runs."""

    def __init__(self, rng: np.random.Generator, *, own: float, parameters: int = len(NAMES)) -> None:
        self.rng = rng
        self.names, self.centre, self.size = NAMES[:parameters], CENTRE[:parameters], SIZE[:parameters]
        self.scatter = expected_scatter(self.names) * np.sqrt(PRIOR_WEIGHT / rng.chisquare(PRIOR_WEIGHT, parameters))
        block = own**2 * (CORRELATION + (1 - CORRELATION) * np.eye(len(TERMS)))
        self.errors = np.kron(np.eye(4), block)[:parameters, :parameters]
        self.root = np.linalg.cholesky(self.errors)

    def run(self, moved: Floats | float = 0.0) -> Point:
        """Return one identification, changed by parts of the parameters' sizes."""
        by_chance = self.scatter * self.rng.standard_normal(self.size.size)
        by_chance += self.root @ self.rng.standard_normal(self.size.size)
        covariance = np.asarray(self.errors * np.outer(self.size, self.size), dtype=float)
        return Point(self.names, self.centre + self.size * (moved + by_chance), covariance)


def chances(draws: int, seed: int) -> None:
    """Print the probabilities of deviations, stated and observed."""
    print(f"probability of a deviation: how often it comes over how often it should, {draws} machines each, seed {seed}")
    heads = " ".join(f"{chance:>7g}" for chance in CHANCES)
    print(f"   baseline  own error   of parameters: {heads}   of elements: {heads}")
    rng = np.random.default_rng(seed)
    for runs in BASELINES:
        for own in (0.002, 0.01, 0.05):
            alone, together = [], []
            for _ in range(draws):
                machine = Drawn(rng, own=own)
                found = deviations([machine.run() for _ in range(runs)], machine.run())
                alone += [one.probability for one in found.parameters]
                together += [one.probability for one in found.elements]
            told = [[float(np.mean(np.array(p) <= chance)) / chance for chance in CHANCES] for p in (alone, together)]
            shown = [" ".join(f"{ratio:7.2f}" for ratio in each) for each in told]
            print(f"   {runs:8d}  {own:9.1%}                  {shown[0]}                {shown[1]}")


def charts(machines: int, seed: int) -> None:
    """Run lengths of charts, stated and met with, and delays until a step is seen."""
    print(f"\ncharts of one stiffness, {machines} machines, seed {seed}; asked: {RUN_LENGTH:.0f} runs to a false alarm")
    print("   baseline   CUSUM limit   runs   EWMA limit   runs   runs until a step of 2 σ, of 3 σ is seen (median; 90 %)")
    rng = np.random.default_rng(seed)
    for runs in BASELINES:
        freedom = PRIOR_WEIGHT + runs - 1
        step, creep = (limit(runs=runs, degrees_of_freedom=freedom) for limit in (step_limit, creep_limit))
        steps = creeps = 0
        delays: dict[float, list[int]] = {2.0: [], 3.0: []}
        for _ in range(machines):
            machine = Drawn(rng, own=0.0005, parameters=1)
            white = Whitening.of([machine.run() for _ in range(runs)], machine.names)
            healthy = np.array([_standardised(white, machine.run()) for _ in range(WEEKS)])
            steps += _alarms(healthy, step, lambda values: cusum(values, reference=CUSUM_REFERENCE))
            creeps += _alarms(healthy, creep, lambda values: np.abs(ewma(values, weight=EWMA_WEIGHT)))
            for size, found in delays.items():
                changed = [_standardised(white, machine.run(size * machine.scatter[0])) for _ in range(LONGEST_DELAY)]
                level = cusum(np.array([*healthy[:20], *changed]), reference=CUSUM_REFERENCE)[20:]
                found.append(int(np.argmax(level > step)) + 1 if np.any(level > step) else LONGEST_DELAY)
        seen = "   ".join(f"{np.median(found):4.0f}; {np.quantile(found, 0.9):3.0f}" for found in delays.values())
        lengths = [machines * WEEKS / max(1, count) for count in (steps, creeps)]
        print(f"   {runs:8d}   {step:11.2f}   {lengths[0]:4.0f}   {creep:10.2f}   {lengths[1]:4.0f}   {seen}")


def _standardised(white: Whitening, point: Point) -> float:
    """Return the deviation of the first parameter, as the charts take it."""
    own = point.covariance[0, 0] / white.size[0] ** 2
    return float(white.change(point)[0] / math.sqrt(own + white.scatter[0]))


def _alarms(deviation: Floats, limit: float, chart: Callable[[Floats], Floats]) -> int:
    """Return how often a chart passes its limit, restarted each time."""
    count = 0
    while deviation.size and np.any(passed := chart(deviation) > limit):
        count += 1
        deviation = deviation[int(np.argmax(passed)) + 1 :]
    return count


def _first(change: float) -> Floats:
    """Return a change of the first parameter alone."""
    return np.where(np.arange(len(NAMES)) == 0, change, 0.0)


def rates(years: int, seed: int) -> None:
    """Print the rate of change: false alarms on healthy machines with seasons, and drifts that are detected."""
    rng = np.random.default_rng(seed)
    stiffness = np.array([describe(name).physical_quantity == "stiffness" for name in NAMES])
    alarms = 0
    for _ in range(years):
        machine, phase = Drawn(rng, own=0.005), rng.uniform(0, 2 * math.pi)
        history = [
            DatedPoint(float(week), machine.run(SEASON * math.sin(2 * math.pi * week / YEAR + phase) * stiffness))
            for week in range(YEAR + WINDOW)
        ]
        told = [{one.element for one in rate_findings(Limits(), history[:week])} for week in range(WINDOW, len(history) + 1)]
        twice = [now & last for last, now in zip(told, told[1:], strict=False)]
        alarms += sum(len(now - before) for before, now in zip([set(), *twice], twice, strict=False))
    print(f"\nrate of change with the default limits, seed {seed}")
    print(f"   healthy, seasons of {SEASON:.0%}: {alarms} alerts of two runs in a row in {years} machine-years")
    for per_week in DRIFTS:
        found = []
        for _ in range(years):
            machine = Drawn(rng, own=0.005)
            history = [DatedPoint(float(week), machine.run(_first(per_week * week))) for week in range(WINDOW)]
            found.append(max((one.severity for one in rate_findings(Limits(), history)), default=None))
        told_of = ", ".join(f"{one.label} {found.count(one) / years:.0%}" for one in Severity)
        print(f"   a stiffness that grows by {per_week:.2%} a week, after {WINDOW} weeks: {told_of}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all three."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.estimator.trend_tests", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("--draws", type=int, default=1500, help="machines for each probability")
    parser.add_argument("--machines", type=int, default=3000, help="machines for each chart")
    parser.add_argument("--years", type=int, default=50, help="machine-years for the rates")
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    chances(chosen.draws, chosen.seed)
    charts(chosen.machines, chosen.seed)
    rates(chosen.years, chosen.seed)


if __name__ == "__main__":
    main()
