"""Updated models for tests: true values with a covariance as an identification might state it, and draws from it."""

import copy
from functools import cache
from typing import Any

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray

from estimator.fit.problem.coordinates import Coordinates
from estimator.machine.document import Machine, parse_machine
from estimator.rotor.condensation import condense
from estimator.updated_model.model import UpdatedModel, with_exact_probes
from tests.estimator.trains import chapter_3_document, truth

Floats = NDArray[np.float64]


def model_of(machine: Machine, *, error: float = 0.02, seed: int = 1) -> UpdatedModel:
    """The nominal machine with correlated errors: direct terms by `error`, everything else by that part of the largest."""
    coefficients, unbalances = truth(machine)
    unknown = condense(machine, speed=np.array([1.0]), direction=np.array([1.0])).unknowns
    largest: dict[str, float] = {}
    for value, one in zip(coefficients, unknown.coefficients, strict=True):
        largest[one.quantity] = max(largest.get(one.quantity, 0.0), abs(value))
    size = [1.0 if one.direct else largest[one.quantity] for one in unknown.coefficients]
    size += [float(np.abs(unbalances).max())] * (2 * unbalances.size)
    rng = np.random.default_rng(seed)
    mixture = rng.standard_normal((len(size), len(size)))
    correlation = np.eye(len(size)) + mixture @ mixture.T / len(size)
    correlation /= np.sqrt(np.outer(np.diag(correlation), np.diag(correlation)))
    scale = error * np.array(size)
    covariance = correlation * np.outer(scale, scale)
    return UpdatedModel.of(machine, coefficients=coefficients, unbalances=unbalances, covariance=covariance)


def draws(model: UpdatedModel, count: int, *, seed: int = 2) -> list[tuple[Floats, NDArray[np.complex128]]]:
    """Coefficients and unbalances drawn from the model's covariance: direct terms log-normal, everything else normal."""
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(model.covariance)
    coordinates = model.coordinates_at(np.ones(1))
    result = []
    for _ in range(count):
        theta = coordinates.theta(model.values + root @ rng.standard_normal(root.shape[0]))
        result.append((coordinates.coefficients(theta), coordinates.excitations(theta)))
    return result


def rich_document() -> dict[str, Any]:
    """Chapter 3 with a seal, all coupling terms, uncertain E and ρ, a bow, equivalent loads, rules, speed dependence."""
    document = copy.deepcopy(chapter_3_document())
    bearings, coupling = document["bearings"], document["couplings"][0]
    bearings[0]["speed_dependence"] = {"form": "piecewise", "knots_rpm": [500, 1500, 3000]}
    bearings[2]["speed_dependence"] = {"form": "polynomial", "knots_rpm": [500, 3000], "coefficients": ["kxx", "cxy"]}
    lateral = {"kxx": 2e4, "kxy": 4e3, "kyx": -4e3, "kyy": 2e4, "cxx": 90.0, "cxy": 1.0, "cyx": -1.0, "cyy": 90.0}
    document["seals"] = [{"id": "G", "shaft": "S1", "station": 0.5, **lateral, "mxx": 0.2, "myy": 0.3}]
    coupling |= {"k_phixy": 1e3, "k_phiyx": 2e3, "c_phix": 5.0, "c_phiy": 6.0, "kx_phiy": 3e4, "ky_phix": -2e4}
    coupling["driver_half"] = {"mass": 0.5, "diametral_inertia": 1e-3, "polar_inertia": 2e-3}
    coupling["load"] = {"force_spread": 10.0, "moment_spread": 2.0}
    document["materials"]["steel"] |= {"young_modulus_spread": 0.02, "density_spread": 0.03, "internal_damping": 1e-6}
    document["shafts"][0]["bow_spread"] = 1e-5
    document["parameters"] = [
        {"names": "bearing.B4.*", "tied_to": "bearing.B2"},
        {"names": "seal.G.kxy", "fixed": True},
        {"names": "disc.D4.unbalance", "fixed": True},
    ]
    for probe in document["probes"]:
        probe |= {"gain_spread": 0.02, "run_out_spread": 1e-6}
    return document


@cache
def rich_model() -> UpdatedModel:
    """A random state of that machine near its document, everything uncertain by a hundredth of its unit."""
    machine = with_exact_probes(parse_machine(rich_document()))
    coordinates = Coordinates.of(condense(machine, speed=np.ones(1), direction=np.ones(1)), unbalance_scale=1e-2)
    theta = coordinates.centre + 0.1 * np.random.default_rng(4).standard_normal(coordinates.size)
    return UpdatedModel(machine, coordinates.names, coordinates.point(theta), np.diag((0.01 * coordinates.unit) ** 2))


def differences(model: UpdatedModel, function: Any) -> np.ndarray:
    """Derivatives (..., n) of a function of the model by its coordinates."""
    columns = []
    for place, size in enumerate(np.sqrt(np.diag(model.covariance))):
        step = np.zeros(model.values.size)
        step[place] = 1e-2 * size
        ahead, behind = (function(replace(model, values=model.values + sign * step)) for sign in (1, -1))
        columns.append((ahead - behind) / (2e-2 * size))
    return np.stack(columns, axis=-1)
