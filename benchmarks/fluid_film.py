"""Trains on fluid films: figures asked beside those measured, on plants that share no physics with the estimator.

The plants are those of `tests/film_plant`: films from finite volumes, truths drawn from priors. One line a figure; status 1
where one falls short. `--short` takes fewer plants and about a minute.

    python -m benchmarks.fluid_film [--short] [--plants N] [--only NAME …]
"""

import argparse
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from threadpoolctl import threadpool_limits

from estimator.arrays import Floats
from estimator.fit.coordinates import Coordinates
from estimator.fit.identify import Identification, Options, identify
from estimator.identification.sweep_correction import sweep_transient
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.response import response
from estimator.statics.equilibrium import film_train
from estimator.updated_model.model import UpdatedModel, model_at
from tests.estimator.statics.films import motor_compressor_document
from tests.film_plant.documents import DAMPING, STIFFNESS, Form, linear_machine, measured
from tests.film_plant.motor_compressor import CASES, CouplingKind, motor_compressor
from tests.film_plant.plant import RPM, Plant
from tests.film_plant.plants import motor_compressor_plant, random_plant
from tests.film_plant.scores import Score, own_form_data, score, true_values
from tests.paths import DATA

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
RATES_RPM_PER_S = (20.0, 80.0)
FOLLOWED_KNOTS = 12
"""Number of knots by which a model follows a film's coefficients in the sweep: the most that a document takes."""
CLEAR = 0.01
"""Part of the amplitude from which on a deviation counts [-]."""


@dataclass(frozen=True)
class Figure:
    """One line: what is measured, what was asked and what came."""

    what: str
    asked: str
    measured: str
    kept: bool

    def __str__(self) -> str:
        return f"  {self.what:<76}{self.asked:>12}{self.measured:>24}{'' if self.kept else '   SHORT'}"


def reference_response(_: int) -> list[Figure]:
    """Return the deviation from the reference arrays' response with their own stiffness and damping."""
    worst = 0.0
    kinds: tuple[CouplingKind, ...] = ("flexible", "rigid")
    with np.load(DATA / "motor-compressor" / "arrays.npz") as arrays:
        speed = arrays["speed"]
        for kind in kinds:
            train = motor_compressor(kind)
            plant = Plant("motor-compressor", train, train, float(speed[0]), float(speed[-1]))
            machine = linear_machine(plant, perturbation=0.0, element_length=1.0)
            for case in sorted({name.split(".")[1] for name in arrays if name.startswith(kind)}):
                named = {what: arrays[f"{kind}.{case}.{what}"] for what in ("stiffness", "damping", "response")}
                found = _phasors(machine, plant, speed, named["stiffness"], named["damping"])
                worst = max(worst, float(np.abs(found - named["response"]).max() / np.abs(named["response"]).max()))
    return [
        Figure("reference arrays, response with their K and C, part of its maximum", "<= 1e-6", f"{worst:.1e}", worst <= 1e-6)
    ]


def reference_statics(_: int) -> list[Figure]:
    """Return the worst deviations from the reference arrays' loads, positions, films and response over all cases."""
    worst = dict.fromkeys(("load", "position", "stiffness", "damping", "response"), 0.0)
    kinds: tuple[CouplingKind, ...] = ("flexible", "rigid")
    with np.load(DATA / "motor-compressor" / "arrays.npz") as arrays:
        speed = arrays["speed"]
        for kind in kinds:
            for case in CASES:
                said = {what: arrays[f"{kind}.{case}.{what}"] for what in ("load", "stiffness", "damping", "response")}
                said["position"] = arrays[f"{kind}.{case}.journal_position"]
                for what, value in _statics_deviations(kind, case, speed, said).items():
                    worst[what] = max(worst[what], value)
    asked = {"load": 0.02, "position": 0.02, "stiffness": 0.02, "damping": 0.02, "response": 0.05}
    of = {"load": "of the load", "position": "of the clearance", "response": "of the maximum"}
    return [
        Figure(
            f"reference arrays, all cases: {what}, part {of.get(what, 'of the largest term')}",
            f"<= {asked[what]:.0%}",
            f"{100 * value:.2f} %",
            value <= asked[what],
        )
        for what, value in worst.items()
    ]


def _statics_deviations(kind: CouplingKind, case: str, speed: Floats, said: dict[str, Floats]) -> dict[str, float]:
    """Return the largest deviation of each quantity in one case, as a part of what it is compared with."""
    machine = parse_machine(motor_compressor_document(kind, case))
    train = film_train(machine)
    found = [one for one in train.over(speed) if one is not None]
    if len(found) < speed.size:
        return dict.fromkeys(said, float("inf"))
    true = motor_compressor(kind, case)
    own = {
        "load": np.stack([one.force for one in found]),
        "position": np.stack([one.position for one in found]),
        "stiffness": np.stack([one.stiffness for one in found]),
        "damping": np.stack([one.damping for one in found]),
    }
    plant = Plant("motor-compressor", true, true, float(speed[0]), float(speed[-1]))
    own["response"] = _phasors(machine, plant, speed, own["stiffness"], own["damping"])
    clearance = np.array([one.clearance for one in train.bearings])
    sizes = {
        "load": np.linalg.norm(said["load"], axis=2)[..., None],
        "position": clearance[:, None],
        "stiffness": np.abs(said["stiffness"]).max(axis=(2, 3))[..., None, None],
        "damping": np.abs(said["damping"]).max(axis=(2, 3))[..., None, None],
        "response": np.abs(said["response"]).max(),
    }
    return {what: float((np.abs(own[what] - said[what]) / sizes[what]).max()) for what in own}


def sweep(_: int) -> list[Figure]:
    """Return the error of the sweep correction against an integration in time, as a part of the deviation."""
    found = []
    plant = motor_compressor_plant(1, "flexible")
    knots = np.linspace(plant.slowest / RPM, plant.fastest / RPM, FOLLOWED_KNOTS)
    machine = linear_machine(plant, form="piecewise", knots_rpm=knots.tolist(), terms="all", perturbation=0.0)
    model = _film_model(machine, plant)
    for rate in RATES_RPM_PER_S:
        record = plant.swept(rate_rpm_per_s=rate, samples=150)
        true = record.instant - record.steady
        began = time.perf_counter()
        predicted = sweep_transient(model, time=record.time, speed=record.speed).instant
        took = time.perf_counter() - began
        clear = np.abs(true) > CLEAR * np.abs(record.steady)
        wrong = float(np.sqrt(np.sum(np.abs(predicted - true) ** 2) / np.sum(np.abs(true) ** 2)))
        size = f"{100 * wrong:.1f} % in {took:.2f} s"
        what = f"sweep correction at {rate:.0f} rpm/s, rms over that of the deviation ({np.mean(clear):.1%} above {CLEAR:.0%})"
        found.append(Figure(what, "<= 10 %", size, wrong <= 0.1))
    return found


def wrong_forms(plants: int) -> list[Figure]:
    """Return, for linear forms on films, which part is refused and how many intervals of the others hold the truth."""
    return [_wrong_form(form, plants) for form in FORMS]


def own_forms(plants: int) -> list[Figure]:
    """Return, for trains that follow their documents' forms, which part is accepted and how many intervals hold the truth."""
    return [figure for form in FORMS for figure in _own_form(form, plants)]


def _wrong_form(form: tuple[Form, int, Terms], plants: int) -> Figure:
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
    return Figure(what, ">= 90 %, 5 s", told, coverage >= 0.9 and max(times) <= 5.0)


def _own_form(form: tuple[Form, int, Terms], plants: int) -> list[Figure]:
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
        Figure(
            f"right {_name(form)}: accepted; coverage; slowest", ">= 90 %, 5 s", told, accepted >= 0.9 and max(times) <= 5.0
        ),
        Figure("    of which not estimable, median", "", f"{withheld:.0%}", True),
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
    began = time.perf_counter()
    found = identify(machine, measurement, OPTIONS)
    return found, time.perf_counter() - began


def _name(form: tuple[Form, int, Terms]) -> str:
    named, knots, terms = form
    return f"{named} of {knots} knots, {'direct terms' if terms == 'direct' else 'all eight'}"


def _train(machine: Machine, speed: Floats) -> CondensedTrain:
    return condense(machine, speed=speed, direction=np.ones(speed.size))


def _phasors(machine: Machine, plant: Plant, speed: Floats, stiffness: Floats, damping: Floats) -> Floats:
    """Return the response of a machine with the coefficients of films at S speeds of n bearings (S, n, 2, 2)."""
    train = _train(machine, speed)
    values = np.tile([one.expected for one in train.unknowns.coefficients], (speed.size, 1))
    for k, one in enumerate(train.unknowns.coefficients):
        kind, element, term = one.name.split(".")
        if kind == "bearing":
            place = (STIFFNESS if term in STIFFNESS else DAMPING).index(term)
            film = stiffness if term in STIFFNESS else damping
            values[:, k] = film[:, int(element[1:]) - 1, place // 2, place % 2]
    excitations = np.zeros(len(train.unknowns.excitations), dtype=complex)
    excitations[: len(plant.train.discs)] = [disc.unbalance for disc in plant.train.discs]
    return np.asarray(response(train, coefficients=values, excitations=excitations))


def _film_model(machine: Machine, plant: Plant) -> UpdatedModel:
    """Return the model of a document with many knots at the plant's own coefficients and unbalances."""
    coordinates = Coordinates.of(_train(machine, np.ones(1)), unbalance_scale=1.0)
    truth, theta = true_values(plant, machine), coordinates.centre.copy()
    for place, one in enumerate(coordinates.parameters):
        theta[place] = one.fitted(truth[one.name].real) if one.name in truth else one.centre
    for disc, first in zip(plant.train.discs, coordinates.excitation_place, strict=False):
        theta[first], theta[first + 1] = disc.unbalance.real, disc.unbalance.imag
    return model_at(machine, coordinates.names, coordinates.point(theta))


PARTS: dict[str, Callable[[int], list[Figure]]] = {
    "reference": reference_response,
    "statics": reference_statics,
    "sweep": sweep,
    "wrong-forms": wrong_forms,
    "own-forms": own_forms,
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Print a line for each figure; status 1 where one falls short."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fluid_film", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--short", action="store_true", help="few plants")
    parser.add_argument("--plants", type=int, default=20, help="number of random plants, seeds 0, 1, …")
    parser.add_argument("--only", nargs="*", choices=tuple(PARTS), default=tuple(PARTS))
    chosen = parser.parse_args(arguments)
    kept = True
    print(f"  {'fluid films':<76}{'asked':>12}{'measured':>24}")
    with threadpool_limits(limits=1):
        for name in chosen.only:
            for figure in PARTS[name](2 if chosen.short else chosen.plants):
                print(figure, flush=True)
                kept &= figure.kept
    if not kept:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
