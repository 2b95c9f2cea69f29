"""Static state and response of the reference motor and compressor, whose arrays another program has computed."""

import numpy as np

from benchmarks.fluid_film.report_line import ReportLine
from estimator.arrays import Floats
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import describe
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.statics.equilibrium import film_train
from tests.estimator.statics.films import motor_compressor_document
from tests.film_plant.documents import DAMPING, STIFFNESS, linear_machine
from tests.film_plant.motor_compressor import CASES, CouplingKind, motor_compressor
from tests.film_plant.plant import Plant
from tests.paths import DATA


def reference_response(_: int) -> list[ReportLine]:
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
        ReportLine(
            "reference arrays, response with their K and C, part of its maximum", "<= 1e-6", f"{worst:.1e}", worst <= 1e-6
        )
    ]


def reference_statics(_: int) -> list[ReportLine]:
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
        ReportLine(
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
    found = [one for one in train.follow(speed) if one is not None]
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


def _phasors(machine: Machine, plant: Plant, speed: Floats, stiffness: Floats, damping: Floats) -> Floats:
    """Return the response of a machine with the coefficients of films at S speeds of n bearings (S, n, 2, 2)."""
    train = condense(machine, speed=speed, direction=np.ones(speed.size))
    values = np.tile([one.expected for one in train.unknowns.coefficients], (speed.size, 1))
    for k, one in enumerate(train.unknowns.coefficients):
        said = describe(one.name)
        if said.element_kind == "bearing":
            terms, film = (STIFFNESS, stiffness) if said.quantity in STIFFNESS else (DAMPING, damping)
            place = terms.index(said.quantity)
            values[:, k] = film[:, int(said.element_id[1:]) - 1, place // 2, place % 2]
    excitations = np.zeros(len(train.unknowns.excitations), dtype=complex)
    excitations[: len(plant.train.discs)] = [disc.unbalance for disc in plant.train.discs]
    return np.asarray(response(train, coefficients=values, excitations=excitations))
