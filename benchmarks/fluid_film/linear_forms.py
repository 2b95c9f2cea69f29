"""Linear coefficients with forms over speed: on films, which follow none of them, and on trains that follow them exactly."""

import time
from typing import Literal

import numpy as np

from benchmarks.fluid_film.report_line import ReportLine
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import Machine
from estimator.phasors.measurement import Measurement
from tests.film_plant.documents import Form, linear_machine, measured
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.plants import random_plant
from tests.film_plant.scores import Score, own_form_data, score, true_values

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


def wrong_forms(plants: int) -> list[ReportLine]:
    """Return, for linear forms on films, which part is refused and how many intervals of the others hold the truth."""
    return [_wrong_form(form, plants) for form in FORMS]


def own_forms(plants: int) -> list[ReportLine]:
    """Return, for trains that follow their documents' forms, which part is accepted and how many intervals hold the truth."""
    return [figure for form in FORMS for figure in _own_form(form, plants)]


def _wrong_form(form: tuple[Form, int, Terms], plants: int) -> ReportLine:
    scores, times = [], []
    for plant, machine in _plants(form, plants):
        found, took = _timed(machine, measured(plant))
        scores.append(score(found, true_values(plant, machine)))
        times.append(took)
    taken = [one for one in scores if one.accepted]
    inside = [held for one in taken for held in one.inside]
    coverage = float(np.mean(inside)) if inside else 1.0
    told = f"{len(scores) - len(taken)}/{len(scores)}; {coverage:.0%}, {max(times):.1f} s"
    what = f"films with {_name(form)}: refused; coverage of the accepted; slowest fit"
    return ReportLine(what, ">= 90 %, 5 s", told, coverage >= 0.9 and max(times) <= 5.0)


def _own_form(form: tuple[Form, int, Terms], plants: int) -> list[ReportLine]:
    scores: list[Score] = []
    times = []
    for seed, (plant, machine) in enumerate(_plants(form, plants)):
        data = own_form_data(plant, machine, seed=seed)
        if data is not None:
            found, took = _timed(machine, data[0])
            scores.append(score(found, data[1]))
            times.append(took)
    accepted = float(np.mean([one.accepted for one in scores]))
    inside = [held for one in scores if one.accepted for held in one.inside]
    coverage = float(np.mean(inside)) if inside else 0.0
    withheld = float(np.median([one.withheld_part for one in scores]))
    told = f"{accepted:.0%} of {len(scores)}; {coverage:.0%}, {max(times):.1f} s"
    return [
        ReportLine(
            f"right {_name(form)}: accepted; coverage; slowest", ">= 90 %, 5 s", told, accepted >= 0.9 and max(times) <= 5.0
        ),
        ReportLine("    of which not estimable, median", "", f"{withheld:.0%}", True),
    ]


def _plants(form: tuple[Form, int, Terms], count: int) -> list[tuple[Plant, Machine]]:
    named, knots, terms = form
    found = []
    for seed in range(count):
        plant = random_plant(seed)
        at = np.linspace(plant.slowest / RPM, plant.fastest / RPM, knots).round()
        found.append((plant, linear_machine(plant, form=named, knots_rpm=at.tolist(), terms=terms, seed=seed)))
    return found


def _timed(machine: Machine, measurement: Measurement) -> tuple[Identification, float]:
    began = time.process_time()
    found = identify(machine, measurement, OPTIONS)
    return found, time.process_time() - began


def _name(form: tuple[Form, int, Terms]) -> str:
    named, knots, terms = form
    return f"{named} of {knots} knots, {'direct terms' if terms == 'direct' else 'all eight'}"
