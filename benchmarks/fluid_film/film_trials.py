"""Trials of identifications by films: a plant of other make, a document, the identification, and its errors."""

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from benchmarks.fluid_film.film_bound import film_bound
from benchmarks.kept_outcomes import kept_or_computed
from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.machine.parameter_description import describe
from estimator.updated_model.derived_quantities import derived_quantities
from tests.film_plant.documents import film_document, measured
from tests.film_plant.plant import Plant
from tests.film_plant.scores import Truths, film_result_truths, film_truths, score, score_derived

OPTIONS = Options(starts=3)
NEXT_RUN = 100_000
"""Seeds of the noise of a plant's next run lie so far from those of its first."""
KINDS = ("clearance", "viscosity", "unbalance", "elevation", "load", "stiffness", "damping", "pedestal")
"""Kinds of quantities whose intervals are judged."""
ASKED_KINDS = tuple(one for one in KINDS if one != "elevation")
"""Kinds over whose coverage the mean is taken."""

Describe = Callable[[Plant, int], dict[str, Any]]
"""Function of a plant and its seed that returns its document."""


@dataclass(frozen=True)
class FilmTrial:
    """One identification by films.

    Attributes:
        accepted: Whether it was accepted.
        verdict: Its verdict.
        took: Processor time of the identification [s].
        again: Processor time of the identification of another run that starts from this one's end [s]; 0 where it was refused.
        inside: By kind, which intervals hold the truth; empty where it was refused.
        errors: By name, with the place of a speed in its stead, error over the bound; empty where it was refused or no bound
            was asked for.
        widths: Standard errors of direct stiffness terms over their bounds.
        failed: Whether it ended with an error of the linear algebra in place of a verdict.
        withheld: Part of the parameters that are not estimable, where that was asked for.
    """

    accepted: bool
    verdict: str
    took: float
    again: float = 0.0
    inside: dict[str, list[bool]] = field(default_factory=dict)
    errors: dict[str, float] = field(default_factory=dict)
    widths: tuple[float, ...] = ()
    failed: bool = False
    withheld: float = 0.0


def by_films(plant: Plant, _: int) -> dict[str, Any]:
    """Return the document that describes a plant by its films."""
    return film_document(plant)


def film_trial(plant: Plant, *, seed: int, bounded: bool = False, document: Describe = by_films) -> FilmTrial:
    """Identify a plant by its films and compare what is told with the truth and, where asked for, with the bound."""
    machine, data = parse_machine(document(plant, seed)), measured(plant, seed=seed)
    began = time.process_time()
    try:
        found = identify(machine, data, OPTIONS)
    except np.linalg.LinAlgError as error:
        return FilmTrial(False, f"failed: {error}", time.process_time() - began, failed=True)
    took = time.process_time() - began
    if not found.accepted:
        return FilmTrial(False, found.verdict, took)
    derived = derived_quantities(machine, found)
    truth, of_films = film_truths(plant), film_result_truths(plant, reported_rpm(machine))
    inside: dict[str, list[bool]] = defaultdict(list)
    for kind in KINDS:
        inside[kind] += score(found, _of_kind(truth, kind)).inside
        inside[kind] += score_derived(derived, _of_kind(of_films, kind)).inside
    if not bounded:
        return FilmTrial(True, found.verdict, took, inside=inside)
    again = _time_again(plant, seed, document, found)
    bound = film_bound(plant, data.speed)
    told = {one.name: one.value for one in found.estimates if one.imaginary is None and one.value is not None}
    told |= {one.name: one.value for one in derived if one.value is not None}
    place = {f"{rpm:g}rpm": number for number, rpm in enumerate(reported_rpm(machine))}
    errors = {
        f"{describe(name).whole}@{place.get(describe(name).knot or '', '')}": (told[name] - true.real) / bound[name]
        for name, true in (truth | of_films).items()
        if name in told and name in bound and kind_of(name) in ASKED_KINDS
    }
    half = {one.name: one for one in derived}
    widths = tuple(
        np.log(one.upper / one.lower) / (2 * 1.96) * one.value / bound[name]
        for name, one in half.items()
        if describe(name).quantity in ("kxx", "kyy") and one.value and one.lower and one.upper and name in bound
    )
    return FilmTrial(True, found.verdict, took, again, inside, errors, widths)


def _time_again(plant: Plant, seed: int, document: Describe, found: Identification) -> float:
    """Return the processor time [s] of the next run's identification, from the last one's end; the document is read anew."""
    machine, data = parse_machine(document(plant, seed)), measured(plant, seed=NEXT_RUN + seed)
    began = time.process_time()
    identify(machine, data, OPTIONS, beginning=found.point)
    return time.process_time() - began


def kind_of(name: str) -> str:
    """Return the kind of an estimate or a derived quantity by its name; its quantity where it is none of `KINDS`."""
    said = describe(name)
    of_scale = describe(said.coefficient)
    said = said if of_scale.term is None else of_scale
    if said.element_kind == "pedestal":
        return said.element_kind
    if said.term is not None:
        return "stiffness" if said.term.order == 0 else "damping"
    return next((kind for kind in KINDS if said.quantity.startswith(kind)), said.quantity)


def coverage_by_kind(trials: Sequence[FilmTrial]) -> dict[str, tuple[float, int]]:
    """Return by kind the part of the intervals that hold the truth, and their number."""
    found = {}
    for kind in KINDS:
        held = [one for trial in trials for one in trial.inside.get(kind, ())]
        found[kind] = (float(np.mean(held)) if held else 1.0, len(held))
    return found


def told_coverage(trials: Sequence[FilmTrial]) -> dict[str, float]:
    """Return by kind the part of the intervals that hold the truth, of kinds that are told."""
    return {kind: part for kind, (part, count) in coverage_by_kind(trials).items() if count}


def mean_coverage(trials: Sequence[FilmTrial]) -> float:
    """Return the mean over kinds of the part of the intervals that hold the truth; 1 where nothing is told."""
    each = coverage_by_kind(trials)
    return float(np.mean([each[kind][0] for kind in ASKED_KINDS if each[kind][1]] or [1.0]))


def trials_of(
    what: str,
    make: Callable[[int], Plant],
    seeds: Sequence[int],
    *,
    bounded: bool = False,
    document: Describe = by_films,
) -> list[FilmTrial]:
    """Return the trials of a plant for each seed; those that are kept under this name are taken from there."""

    def computed(seed: int) -> FilmTrial:
        return film_trial(make(seed), seed=seed, bounded=bounded, document=document)

    return [kept_or_computed(f"{what}, {seed}", FilmTrial, partial(computed, seed)) for seed in seeds]


def _of_kind(truth: Truths, kind: str) -> Truths:
    return {name: value for name, value in truth.items() if kind_of(name) == kind}
