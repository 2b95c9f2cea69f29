"""Machine documents that ask for as much as they may: ten kinds, each as large as the door lets in."""

from collections.abc import Callable, Mapping
from typing import Any

from estimator.machine.checks.document_size import accepted_machine
from estimator.machine.document import DocumentError

LENGTH = 3.0
"""Length of each shaft [m]."""


_BEARING = {"kxx": 2e7, "kxy": 4e6, "kyx": -6e6, "kyy": 3e7, "cxx": 3e4, "cxy": -4e3, "cyx": -4e3, "cyy": 5e4}
_SEAL = {"kxx": 1e6, "kxy": 2e5, "kyx": -2e5, "kyy": 1e6, "cxx": 1e3, "cxy": 0.0, "cyx": 0.0, "cyy": 1e3}
_COUPLING = {"kxx": 2e6, "kxy": 5e4, "kyx": -5e4, "kyy": 2e6, "k_phix": 2.5e4, "k_phiy": 2.5e4}
_COUPLING_DAMPING = {"cxx": 500.0, "cxy": 0.0, "cyx": 0.0, "cyy": 500.0}


def train(
    *,
    shafts: int = 2,
    sections: int = 4,
    bearings: int = 4,
    discs: int = 4,
    seals: int = 0,
    probes: int = 8,
    knots: int = 0,
    spread: bool = False,
    loads: bool = False,
    element_length: float | None = None,
    rules: int = 0,
) -> dict[str, Any]:
    """Return a train of equal shafts, coupled one behind the other; its parts are spread over all of them.

    sections, bearings, discs, seals, probes: in all. knots: knots of coefficients that follow the speed. spread: gains,
    run-outs, bows and materials that are not known exactly. loads: in the couplings. rules: for parameters.
    """
    unsure = {"young_modulus_spread": 0.02, "density_spread": 0.01} if spread else {}
    follows = _speed_dependence(knots)
    document: dict[str, Any] = {
        "schema_version": 1,
        "id": "large",
        "plant": "examples",
        "name": "Large train",
        "speed_range": {"minimum_rpm": 300, "maximum_rpm": 3600},
        "materials": {"steel": {"young_modulus": 2.06e11, "density": 7850.0, **unsure}},
        "shafts": [_shaft(number, max(1, sections // shafts), spread=spread) for number in range(shafts)],
        "discs": [_disc(number, _place(number, discs, shafts)) for number in range(discs)],
        "bearings": [{"id": f"B{n}", **_place(n, bearings, shafts), **_BEARING, **follows} for n in range(bearings)],
        "seals": [{"id": f"L{n}", **_place(n, seals, shafts), **_SEAL, **follows} for n in range(seals)],
        "couplings": [_coupling(number, loads=loads) for number in range(shafts - 1)],
        "probes": [_probe(n, _place(n // 2, (probes + 1) // 2, shafts), spread=spread) for n in range(probes)],
    }
    if rules:
        document["parameters"] = [{"names": f"bearing.B*.k?{'xy'[n % 2]}", "spread": 0.5} for n in range(rules)]
    if element_length is not None:
        document["element_length"] = element_length
    return document


def _place(number: int, of: int, shafts: int) -> dict[str, Any]:
    """Place parts on one shaft after the other, each at a station of its own."""
    shaft, turn = number % shafts, number // shafts
    return {"shaft": f"S{shaft}", "station": round(LENGTH * (turn + 0.5) / (of // shafts + 1), 4)}


def _speed_dependence(knots: int) -> dict[str, Any]:
    dependence = {"form": "piecewise", "knots_rpm": [300.0 + 3000.0 * n / max(1, knots - 1) for n in range(knots)]}
    return {"speed_dependence": dependence} if knots else {}


def _shaft(number: int, sections: int, *, spread: bool) -> dict[str, Any]:
    return {
        "id": f"S{number}",
        "sections": [
            {"length": LENGTH / sections, "outer_diameter": 0.12 + 0.01 * (n % 2), "material": "steel"}
            for n in range(sections)
        ],
        **({"bow_spread": 1e-5} if spread else {}),
    }


def _disc(number: int, place: dict[str, Any]) -> dict[str, Any]:
    return {
        "id": f"D{number}",
        **place,
        "mass": 40.0,
        "diametral_inertia": 0.5,
        "polar_inertia": 0.8,
        "unbalance": {"magnitude": 1e-3, "angle_deg": 40.0 * number},
    }


def _coupling(number: int, *, loads: bool) -> dict[str, Any]:
    return {
        "id": f"C{number}",
        "driver": f"S{number}",
        "driven": f"S{number + 1}",
        **_COUPLING,
        **_COUPLING_DAMPING,
        **({"load": {"force_spread": 100.0, "moment_spread": 100.0}} if loads else {}),
    }


def _probe(number: int, place: dict[str, Any], *, spread: bool) -> dict[str, Any]:
    return {
        "id": f"P{number}",
        **place,
        "angle_deg": 45.0 + 90.0 * (number % 2),
        **({"gain_spread": 0.02, "run_out_spread": 1e-6} if spread else {}),
    }


KINDS: Mapping[str, Callable[[int], dict[str, Any]]] = {
    "sections": lambda n: train(sections=2 * n),
    "short elements": lambda n: train(element_length=2 * LENGTH / n),
    "shafts": lambda n: train(shafts=min(n, 20), sections=10 * n, bearings=2 * n, discs=n, probes=2 * n, loads=True),
    "bearings": lambda n: train(bearings=n, rules=200),
    "bearings that follow the speed": lambda n: train(bearings=max(1, n // 4), knots=12),
    "seals": lambda n: train(seals=n),
    "discs": lambda n: train(discs=n),
    "probes": lambda n: train(probes=n),
    "unsure probes": lambda n: train(probes=n, spread=True),
    "all at once": lambda n: train(
        shafts=min(20, 1 + n // 10), sections=4 * n, bearings=n, discs=n, seals=n // 2, probes=2 * n, spread=True, loads=True
    ),
}
"""Documents that grow with a number, by name."""
LARGEST = 600
"""Largest of these numbers."""


def largest(kind: str) -> dict[str, Any]:
    """Return the largest document of a kind that is accepted."""
    low, high = 2, LARGEST
    while low < high:
        middle = (low + high + 1) // 2
        if _is_let_in(KINDS[kind](middle)):
            low = middle
        else:
            high = middle - 1
    return KINDS[kind](low)


def _is_let_in(document: dict[str, Any]) -> bool:
    try:
        accepted_machine(document)
    except DocumentError:
        return False
    return True
