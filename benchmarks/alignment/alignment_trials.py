"""Trials of alignment: a misaligned plant of other make, a baseline of its runs, and one run after its coupling has moved."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from msgspec import structs

from benchmarks.fluid_film.film_bound import DRAWN_DISCREPANCY
from benchmarks.fluid_film.film_trials import OPTIONS
from benchmarks.kept_outcomes import kept_or_computed
from estimator.alignment.alignment_change import alignment_changes
from estimator.alignment.load_change import load_changes
from estimator.fit.estimates import CONFIDENCE_95
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.machine.film_speeds import reported_rpm
from estimator.updated_model.derived_quantities import Derived, derived_quantities
from estimator.updated_model.model import updated_model
from tests.film_plant.discrepancy import DiscrepancySize
from tests.film_plant.documents import film_document, measured, measured_gaps
from tests.film_plant.misalignment import LEFT, ONE_SUPPLY, drawn, left_off, spread_of_elevations, true_alignment
from tests.film_plant.motor_compressor import CouplingKind
from tests.film_plant.plant import Plant
from tests.film_plant.plants import MOST_DRAWS, Priors, reference_plant
from tests.film_plant.scatter import run_of
from tests.film_plant.scores import film_result_truths
from tests.film_plant.statics import NoEquilibrium

BASELINE = 6
"""Runs of a baseline."""
SAMPLES = 150
PRIOR_PART = 0.8
"""Largest error of a change that is called determined, as a part of what is believed possible [-]."""


@dataclass(frozen=True)
class ReportedInterval:
    """Lower and upper end of the 95 % interval reported of one quantity, and its true value [SI]."""

    name: str
    lower: float
    upper: float
    true: float

    @property
    def holds(self) -> bool:
        """Return whether the interval holds the truth."""
        return self.lower <= self.true <= self.upper

    @property
    def half(self) -> float:
        """Return the half width of the interval."""
        return (self.upper - self.lower) / 2


@dataclass(frozen=True)
class AlignmentTrial:
    """One plant.

    Attributes:
        verdicts: Verdicts of the runs that were refused.
        runs: Number of runs.
        absolute: Offsets, angles and loads that one run determines.
        changes: Changes against the baseline: of offsets and angles that are determined, and of loads.
        withheld: Offsets and angles that one run does not determine, by name.
        centred: Offsets, angles and loads that the same run determines with its shaft centreline.
    """

    verdicts: tuple[str, ...]
    runs: int
    absolute: tuple[ReportedInterval, ...] = ()
    changes: tuple[ReportedInterval, ...] = ()
    withheld: tuple[str, ...] = ()
    centred: tuple[ReportedInterval, ...] = ()


def plant_of(seed: int, kind: CouplingKind) -> Plant:
    """Return a misaligned plant: of even seeds a motor and compressor, of odd ones a turbine and its generator."""
    return reference_plant(seed, kind, priors=ONE_SUPPLY, discrepancy=DiscrepancySize(), alter=left_off(kind))


def believed_of(plant: Plant, kind: CouplingKind) -> Priors:
    """Return what a document states: of elevations what offset and angle of the coupling, as they are drawn, ask for."""
    spread = spread_of_elevations(plant, kind)
    return replace(ONE_SUPPLY, elevation=spread, rigid_elevation=spread)


def trial_of(seed: int, kind: CouplingKind) -> AlignmentTrial:
    """Return what became of a plant, computed where it is not kept."""
    return kept_or_computed(trial_name(seed, kind), AlignmentTrial, partial(alignment_trial, seed, kind))


def trial_name(seed: int, kind: CouplingKind) -> str:
    """Return the name under which the trial of a plant is kept."""
    return f"alignment, {kind}, {seed}"


def alignment_trial(seed: int, kind: CouplingKind) -> AlignmentTrial:
    """Identify a baseline and one later run of a plant and compare what is told of alignment and loads with the truth."""
    rng = np.random.default_rng([seed, len(kind)])
    plant = plant_of(seed, kind)
    machine = parse_machine(film_document(plant, priors=believed_of(plant, kind), discrepancy=DRAWN_DISCREPANCY))
    runs = [run_of(plant, rng) for _ in range(BASELINE)]
    later, last = _moved(plant, kind, rng)
    runs.append(last)
    fits = [identify(machine, measured(one, seed=100 * seed + number), OPTIONS) for number, one in enumerate(runs)]
    refused = tuple(one.verdict for one in fits if not one.accepted)
    if not (fits[0].accepted and fits[-1].accepted):
        return AlignmentTrial(refused, len(runs))
    first = derived_quantities(machine, fits[0])
    truth = true_alignment(runs[0]) | _loads(runs[0], machine)
    absolute = _absolute(first, truth)
    alignment = true_alignment(plant)
    return AlignmentTrial(
        refused,
        len(runs),
        absolute,
        tuple(_changes(machine, fits, plant, later, runs[-1])),
        tuple(one.name for one in first if one.name in alignment and one.value is None),
        _with_centreline(machine, runs[0], fits[0], seed, truth),
    )


def _moved(plant: Plant, kind: CouplingKind, rng: np.random.Generator) -> tuple[Plant, Plant]:
    """Return the plant with its second shaft moved, and a run of it; what whirls or touches is drawn anew."""
    for _ in range(MOST_DRAWS):
        later = replace(plant, train=drawn(plant.train, LEFT[kind], rng))
        try:
            return later, run_of(later, rng)
        except (RuntimeError, NoEquilibrium):
            continue
    raise RuntimeError(f"{plant.name} whirls wherever its second shaft is moved")


def _with_centreline(
    machine: Machine, run: Plant, fitted: Identification, seed: int, truth: dict[str, complex]
) -> tuple[ReportedInterval, ...]:
    """Return what the first run tells with gaps of 1 µm noise, whose zeros drift by 5 µm; nothing where it is refused."""
    films = run.films(run.speeds(SAMPLES))
    gaps = measured_gaps(films, np.random.default_rng([seed, 3]))
    measurement = structs.replace(measured(run, seed=100 * seed, clean=(films.speed, run.phasors(films))), gaps=gaps)
    found = identify(machine, measurement, OPTIONS, beginning=fitted.point)
    return _absolute(derived_quantities(machine, found), truth) if found.accepted else ()


def _absolute(found: Sequence[Derived], truth: dict[str, complex]) -> tuple[ReportedInterval, ...]:
    return tuple(_interval(one, truth[one.name].real) for one in found if one.name in truth and one.value is not None)


def _interval(one: Derived, true: float) -> ReportedInterval:
    assert one.lower is not None
    assert one.upper is not None
    return ReportedInterval(one.name, one.lower, one.upper, true)


def _loads(plant: Plant, machine: Machine) -> dict[str, complex]:
    """Return the true loads at running speed by name."""
    return {name: value for name, value in film_result_truths(plant, reported_rpm(machine)).items() if ".load_" in name}


def _changes(
    machine: Machine, fits: Sequence[Identification], plant: Plant, later: Plant, last: Plant
) -> Iterator[ReportedInterval]:
    """Yield the changes against the baseline's accepted runs: of offsets and angles that are determined, and of all loads.

    last: plant as it is in the last run. The baseline's loads are those of the plant without the scatter of single runs.
    """
    *baseline, newest = [updated_model(machine, one) for one in fits if one.accepted]
    before, after = true_alignment(plant), true_alignment(later)
    for one in alignment_changes(baseline, newest):
        if one.error <= PRIOR_PART * one.believed:
            yield _around(one.name, one.value, one.error, (after[one.name] - before[one.name]).real)
    first, now = _loads(plant, machine), _loads(last, machine)
    for load in load_changes(baseline, newest):
        yield _around(load.name, load.value, load.error, (now[load.name] - first[load.name]).real)


def _around(name: str, value: float, error: float, true: float) -> ReportedInterval:
    return ReportedInterval(name, value - CONFIDENCE_95 * error, value + CONFIDENCE_95 * error, true)
