"""Small trains that have what §6.5 of the thesis leaves to future work, and their true parameters."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from benchmarks.documents import Document
from estimator.machine.document import Machine, parse_machine
from estimator.machine.parameter_description import describe

RMS = 0.01
"""Rms of the complex noise, part of each amplitude."""
NOMINAL_ERROR = 1.25
"""Ratio of the document's coefficients of a seal, or of a coupling's further terms, to the truth."""
KNOTS_RPM = (300.0, 2000.0, 4500.0)
INTERNAL_DAMPING = 5e-5
"""[s]"""
SEAL = {"kxx": 4e4, "kxy": 3e4, "kyx": -3e4, "kyy": 5e4, "cxx": 120.0, "cxy": 15.0, "cyx": -15.0, "cyy": 140.0}
SEAL |= {"mxx": 0.8, "myy": 0.6}
TERMS = {"k_phixy": 150.0, "k_phiyx": 90.0, "c_phix": 2.0, "c_phiy": 3.0, "kx_phiy": 4e3, "ky_phix": -3e3}
GROWTH = {"kxx": (1.0, 1.3, 1.6), "kyy": (1.0, 1.2, 1.4), "cxx": (1.0, 0.7, 0.5), "cyy": (1.0, 0.75, 0.6)}
"""Factors on bearing B2's coefficients at the knots: as an oil film's, stiffer with speed and less damped."""
BOW: dict[str, complex] = {
    "shaft.S1.bow": 2e-4 * complex(np.exp(0.7j)),
    "shaft.S2.bow": 1.5e-4 * complex(np.exp(-2.1j)),
}
LOAD: dict[str, complex] = {
    "coupling.C1.force_x": 30.0 + 10j,
    "coupling.C1.force_y": -15.0 + 20j,
    "coupling.C1.moment_x": 3.0 - 1j,
    "coupling.C1.moment_y": 1.0 + 2j,
}


def plain_document() -> Document:
    """Return two short shafts, each with a disc and two bearings, a coupling that is soft in bending, probes at all of
    them."""
    section = {"length": 0.8, "outer_diameter": 0.02, "material": "steel"}
    places = (("B1", "S1", 0.1), ("B2", "S1", 0.65), ("B3", "S2", 0.15), ("B4", "S2", 0.7))
    stiffness = ((2.5e5, 3.1e5), (2.8e5, 3.6e5), (2.3e5, 3.0e5), (2.1e5, 2.9e5))
    ends = (*places, ("E", "S1", 0.8), ("F", "S2", 0.0))
    discs = (("D1", "S1", 0.35, 2.0, 1e-3, 36.0), ("D2", "S2", 0.45, 2.5, 8e-4, 240.0))
    return {
        "schema_version": 1,
        "id": "future-work",
        "plant": "benchmarks",
        "name": "Two short shafts",
        "speed_range": {"minimum_rpm": 100, "maximum_rpm": 6000},
        "materials": {"steel": {"young_modulus": 2.1e11, "density": 7800.0, "poisson_ratio": 0.3}},
        "shafts": [{"id": "S1", "sections": [section]}, {"id": "S2", "sections": [section]}],
        "discs": [
            {"id": name, "shaft": shaft, "station": station, "mass": mass, "diametral_inertia": 0.004,
             "polar_inertia": 0.008, "unbalance": {"magnitude": size, "angle_deg": angle}}
            for name, shaft, station, mass, size, angle in discs
        ],
        "bearings": [
            {"id": name, "shaft": shaft, "station": station, "kxx": kxx, "kyy": kyy, "kxy": 5e4, "kyx": -4e4,
             "cxx": 300.0, "cyy": 350.0, "cxy": 20.0, "cyx": 30.0}
            for (name, shaft, station), (kxx, kyy) in zip(places, stiffness, strict=True)
        ],
        "couplings": [
            {"id": "C1", "driver": "S1", "driven": "S2", "kxx": 2.1e5, "kxy": 2e4, "kyx": 3e4, "kyy": 2e5, "k_phix": 900.0,
             "k_phiy": 800.0, "cxx": 225.0, "cxy": 20.0, "cyx": 50.0, "cyy": 295.0,
             "driver_half": {"mass": 0.9, "diametral_inertia": 0.002, "polar_inertia": 0.003},
             "driven_half": {"mass": 0.7, "diametral_inertia": 0.001, "polar_inertia": 0.0025}}
        ],
        "probes": [
            {"id": f"{name}{axis}", "shaft": shaft, "station": station, "angle_deg": angle}
            for name, shaft, station in ends
            for axis, angle in (("X", 0), ("Y", 90))
        ],
        "noise": {"relative": RMS, "floor": 0.0},
    }  # fmt: skip


@dataclass(frozen=True)
class Feature:
    """Something that the thesis's model does not have.

    extend: writes it into a document, its own coefficients times a factor. truth: by parameter name, its true values.
    element: whose coefficients it changes, which are therefore no measure of the error that leaving it out makes.
    """

    title: str
    extend: Callable[[Document, float], None]
    truth: Mapping[str, complex]
    element: str | None = None

    def machine(self, *, factor: float = 1.0) -> Machine:
        """Return the train with the feature, its own coefficients off by a factor."""
        document = plain_document()
        self.extend(document, factor)
        return parse_machine(document)


def plain() -> Machine:
    """Return the train with nothing that the thesis's model does not have."""
    return parse_machine(plain_document())


def _times(values: Mapping[str, float], factor: float) -> dict[str, float]:
    return {name: factor * value for name, value in values.items()}


def _speed_dependence(document: Document, _: float) -> None:
    document["bearings"][1]["speed_dependence"] = {
        "form": "piecewise",
        "knots_rpm": list(KNOTS_RPM),
        "coefficients": list(GROWTH),
    }


def _coupling_terms(document: Document, factor: float) -> None:
    document["couplings"][0].update(_times(TERMS, factor))


def _seals(document: Document, factor: float) -> None:
    document["seals"] = [{"id": "N1", "shaft": "S1", "station": 0.5, **_times(SEAL, factor)}]
    document["probes"] += [
        {"id": f"N1{axis}", "shaft": "S1", "station": 0.5, "angle_deg": angle} for axis, angle in (("X", 0), ("Y", 90))
    ]


def _internal_damping(document: Document, factor: float) -> None:
    document["materials"]["steel"]["internal_damping"] = factor * INTERNAL_DAMPING


def _bow(document: Document, _: float) -> None:
    for shaft in document["shafts"]:
        shaft["bow_spread"] = 1e-3


def _load(document: Document, _: float) -> None:
    document["couplings"][0]["load"] = {"force_spread": 100.0, "moment_spread": 10.0}


def _at_knots() -> dict[str, complex]:
    bearing = plain_document()["bearings"][1]
    return {
        f"bearing.B2.{name}@{knot:g}rpm": bearing[name] * factor
        for name, factors in GROWTH.items()
        for knot, factor in zip(KNOTS_RPM, factors, strict=True)
    }


FEATURES = {
    "speed-dependent": Feature("Speed-dependent coefficients", _speed_dependence, _at_knots(), element="bearing.B2"),
    "coupling-terms": Feature(
        "Cross-coupled rotational and translation-rotation terms of the coupling",
        _coupling_terms,
        {f"coupling.C1.{name}": value for name, value in TERMS.items()},
    ),
    "seals": Feature("Seals", _seals, {f"seal.N1.{name}": value for name, value in SEAL.items()}),
    "internal-damping": Feature("Internal damping of the shafts", _internal_damping, {}),
    "bow": Feature("Residual shaft bow", _bow, BOW),
    "load": Feature("Misalignment as an equivalent load", _load, LOAD),
}


def true_point(machine: Machine, names: tuple[str, ...], truth: Mapping[str, complex]) -> dict[str, float]:
    """Return true values by the names of fit coordinates, positive ones as logarithms: `truth`, else the document's."""
    values: dict[str, complex] = dict(truth)
    for kind, parts in (("bearing", machine.bearings), ("seal", machine.seals), ("coupling", machine.couplings)):
        for part in parts:
            for name, value in part.model_dump().items():
                if isinstance(value, float):
                    values.setdefault(f"{kind}.{part.id}.{name}", value)
    for disc in machine.discs:
        if disc.unbalance is not None:
            angle = math.radians(disc.unbalance.angle_deg)
            values[f"disc.{disc.id}.unbalance"] = disc.unbalance.magnitude * complex(np.exp(1j * angle))
    return {name: _coordinate(name, values) for name in names}


def _coordinate(name: str, values: Mapping[str, complex]) -> float:
    said = describe(name)
    if said.component is not None:
        return values[said.whole].real if said.component == "real" else values[said.whole].imag
    return math.log(values[name].real) if said.positive else values[name].real
