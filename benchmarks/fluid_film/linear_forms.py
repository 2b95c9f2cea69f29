"""Linear coefficients with forms over speed: on films, which follow none of them, and on trains that follow them exactly."""

import time
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np

from benchmarks.fluid_film.film_trials import FilmTrial
from benchmarks.fluid_film.report_line import ReportLine
from benchmarks.kept_outcomes import kept_or_computed
from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from tests.film_plant.documents import Form, linear_machine, measured
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.plants import random_plant
from tests.film_plant.scores import Truths, own_form_data, score, true_values

Terms = Literal["direct", "all"]
FORMS: tuple[tuple[Form, int, Terms], ...] = (
    ("polynomial", 2, "direct"),
    ("polynomial", 3, "direct"),
    ("piecewise", 4, "direct"),
    ("polynomial", 2, "all"),
    ("polynomial", 3, "all"),
    ("piecewise", 4, "all"),
)
OPTIONS = Options(starts=3)
LEAST_ACCEPTED, LEAST_COVERAGE, SLOWEST = 0.9, 0.9, 5.0
"""Least part accepted and least coverage [-], and the longest processor time of one fit [s]."""
LINEAR = "linear"
"""Kind of quantities under which the intervals of linear coefficients are kept."""
UNSTABLE = "the train would be unstable"
"""Verdict on a plant that is left out."""


def wrong_forms(plants: int) -> list[ReportLine]:
    """Return, for linear forms on films, which part is refused and how many intervals of the others hold the truth."""
    return [_wrong_form(form, plants) for form in FORMS]


def own_forms(plants: int) -> list[ReportLine]:
    """Return, for trains that follow their documents' forms, which part is accepted and how many intervals hold the truth."""
    return [figure for form in FORMS for figure in _own_form(form, plants)]


def _kept(what: str, compute: Callable[[int], FilmTrial], plants: int) -> list[FilmTrial]:
    return [kept_or_computed(f"{what}, {seed}", FilmTrial, partial(compute, seed)) for seed in range(plants)]


def _wrong_form(form: tuple[Form, int, Terms], plants: int) -> ReportLine:
    def computed(seed: int) -> FilmTrial:
        plant, machine = _plant(form, seed)
        return _trial(machine, measured(plant), true_values(plant, machine))

    trials = _kept(f"films with {_name(form)}", computed, plants)
    refused, slowest = sum(not one.accepted for one in trials), max(one.took for one in trials)
    inside = [held for one in trials for held in one.inside.get(LINEAR, ())]
    coverage = float(np.mean(inside)) if inside else 1.0
    told = f"{refused}/{len(trials)}; {f'{coverage:.0%}' if inside else 'none told'}, {slowest:.1f} s"
    what = f"films with {_name(form)}: refused; coverage of the accepted; slowest fit"
    return ReportLine(what, ">= 90 %, 5 s", told, coverage >= LEAST_COVERAGE and slowest <= SLOWEST)


def _own_form(form: tuple[Form, int, Terms], plants: int) -> list[ReportLine]:
    def computed(seed: int) -> FilmTrial:
        plant, machine = _plant(form, seed)
        data = own_form_data(plant, machine, seed=seed)
        return FilmTrial(False, UNSTABLE, 0.0, failed=True) if data is None else _trial(machine, *data)

    trials = _kept(f"right {_name(form)}", computed, plants)
    trials = [one for one in trials if not one.failed]
    accepted = float(np.mean([one.accepted for one in trials])) if trials else 0.0
    inside = [held for one in trials for held in one.inside.get(LINEAR, ())]
    coverage, slowest = float(np.mean(inside)) if inside else 0.0, max((one.took for one in trials), default=0.0)
    withheld = float(np.median([one.withheld for one in trials])) if trials else 1.0
    told = f"{accepted:.0%} of {len(trials)}; {coverage:.0%}, {slowest:.1f} s"
    return [
        ReportLine(
            f"right {_name(form)}: accepted; coverage; slowest",
            ">= 90 %, 5 s",
            told,
            accepted >= LEAST_ACCEPTED and slowest <= SLOWEST,
        ),
        ReportLine("    of which not estimable, median", "", f"{withheld:.0%}", True),
    ]


def _plant(form: tuple[Form, int, Terms], seed: int) -> tuple[Plant, Machine]:
    named, knots, terms = form
    plant = random_plant(seed)
    at = np.linspace(plant.slowest / RPM, plant.fastest / RPM, knots).round()
    return plant, linear_machine(plant, form=named, knots_rpm=at.tolist(), terms=terms, seed=seed)


def _trial(machine: Machine, measurement: Measurement, truth: Truths) -> FilmTrial:
    began = time.process_time()
    found = identify(machine, measurement, OPTIONS)
    took, compared = time.process_time() - began, score(found, truth)
    inside = {LINEAR: list(compared.inside)} if found.accepted else {}
    return FilmTrial(found.accepted, found.verdict, took, inside=inside, withheld=compared.withheld_part)


def _name(form: tuple[Form, int, Terms]) -> str:
    named, knots, terms = form
    return f"{named} of {knots} knots, {'direct terms' if terms == 'direct' else 'all eight'}"
