"""Trains, truth and data that the estimator's tests share, and a dense model of a train that owes condensation nothing."""

import copy
import math
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from hypothesis import settings
from numpy.typing import NDArray

from estimator.machine.document import Machine, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.condensation import condense

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Document = dict[str, Any]

ROOT = Path(__file__).parents[2]
LATERAL = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")
COEFFICIENTS = (*LATERAL, "k_phix", "k_phiy")
CROSS = ("kxy", "kyx", "cxy", "cyx")

few_examples = settings(max_examples=20, deadline=None, derandomize=True)
"""Enough for a law with a handful of real parameters, the same examples in every run."""


@cache
def _chapter_3_as_read() -> Document:
    document: Document = yaml.safe_load((ROOT / "examples" / "thesis-chapter-3.yaml").read_text(encoding="utf-8"))
    return document


def chapter_3_document() -> Document:
    """A fresh copy of the Chapter 3 document."""
    return copy.deepcopy(_chapter_3_as_read())


@cache
def chapter_3() -> Machine:
    """The Chapter 3 train."""
    return parse_machine(chapter_3_document())


@cache
def ross() -> tuple[Floats, Complexes]:
    """Speeds (300,) [rad/s] and phasors (300, 8) [m] of the Chapter 3 train as ROSS computes them."""
    with np.load(ROOT / "tests" / "data" / "thesis-chapter-3.npz") as data:
        speed, response = data["speed"], data["response"]
    speed.flags.writeable = response.flags.writeable = False
    return speed, response


def truth(machine: Machine) -> tuple[Floats, Complexes]:
    """Nominal coefficients (K,) and unbalances (P,) of a machine, which must all be given."""
    unknown = condense(machine, speed=np.array([1.0]), direction=np.array([1.0])).unknowns
    return (
        np.array([one.nominal for one in unknown.coefficients], dtype=float),
        np.array([one.nominal for one in unknown.unbalances], dtype=complex),
    )


def noisy(clean: Complexes, *, seed: int, relative: float = 0.01) -> Complexes:
    """Phasors with complex Gaussian noise whose rms is a part of the amplitude."""
    rng = np.random.default_rng(seed)
    noise = rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape)
    return np.asarray(clean + relative / math.sqrt(2) * np.abs(clean) * noise)


def without(document: Document, parts: tuple[str, ...], names: tuple[str, ...] = COEFFICIENTS) -> Document:
    """A copy of a document whose bearings or couplings lack some nominal coefficients, and whose discs lack unbalances."""
    changed = copy.deepcopy(document)
    for part in (one for kind in parts for one in changed[kind]):
        for name in names:
            part.pop(name, None)
    for disc in changed["discs"]:
        disc.pop("unbalance", None)
    return changed


def perturbed(document: Document, *, seed: int, span: float = 0.5) -> Document:
    """A copy of a document with every nominal coefficient off by a factor uniform between 1 - span and 1 + span."""
    rng = np.random.default_rng(seed)
    changed = copy.deepcopy(document)
    for part in (*changed["bearings"], *changed["couplings"]):
        for name in COEFFICIENTS:
            if name in part:
                part[name] *= 1 + rng.uniform(-span, span)
    return changed


def mirrored(document: Document) -> Document:
    """A copy of a document as a mirror shows it (y -> -y): the same machine turning the other way."""
    changed = copy.deepcopy(document)
    changed["rotation"] = "negative" if document.get("rotation", "positive") == "positive" else "positive"
    for part in (*changed["bearings"], *changed.get("couplings", ())):
        for name in CROSS:
            if name in part:
                part[name] = -part[name]
    for probe in changed["probes"]:
        probe["angle_deg"] = -probe["angle_deg"]
    for disc in changed["discs"]:
        if "unbalance" in disc:
            disc["unbalance"]["angle_deg"] = -disc["unbalance"]["angle_deg"]
    return changed


def one_disc_document(
    *,
    length: float = 1.0,
    diameter: float = 0.03,
    density: float = 7800.0,
    disc_station: float | None = None,
    mass: float = 5.0,
    diametral_inertia: float = 0.02,
    polar_inertia: float = 0.04,
    kxx: float = 2e6,
    kyy: float = 2e6,
    kxy: float = 0.0,
    kyx: float = 0.0,
    cxx: float = 300.0,
    cyy: float = 300.0,
    element_length: float = 0.25,
) -> Document:
    """One steel shaft on a bearing at each end, one disc (by default in the middle), probes x and y at the disc."""
    station = length / 2 if disc_station is None else disc_station
    bearing = {"kxx": kxx, "kxy": kxy, "kyx": kyx, "kyy": kyy, "cxx": cxx, "cxy": 0.0, "cyx": 0.0, "cyy": cyy}
    return {
        "schema_version": 1,
        "id": "one-disc",
        "plant": "tests",
        "name": "One disc between two bearings",
        "speed_range": {"minimum_rpm": 100, "maximum_rpm": 6000},
        "materials": {"steel": {"young_modulus": 2.1e11, "density": density, "poisson_ratio": 0.3}},
        "shafts": [{"id": "S", "sections": [{"length": length, "outer_diameter": diameter, "material": "steel"}]}],
        "element_length": element_length,
        "discs": [
            {
                "id": "D",
                "shaft": "S",
                "station": station,
                "mass": mass,
                "diametral_inertia": diametral_inertia,
                "polar_inertia": polar_inertia,
                "unbalance": {"magnitude": 1e-3, "angle_deg": 30},
            }
        ],
        "bearings": [
            {"id": "B1", "shaft": "S", "station": 0.0, **bearing},
            {"id": "B2", "shaft": "S", "station": length, **bearing},
        ],
        "probes": [
            {"id": "X", "shaft": "S", "station": station, "angle_deg": 0},
            {"id": "Y", "shaft": "S", "station": station, "angle_deg": 90},
        ],
    }


def dense_elements(machine: Machine) -> tuple[Floats, Floats]:
    """Stiffness and damping (N, N) of the nominal bearings and couplings, written down entry by entry."""
    rotor = assemble_rotor(machine)
    stiffness, damping = np.zeros((rotor.size, rotor.size)), np.zeros((rotor.size, rotor.size))
    for bearing in machine.bearings:
        x = 4 * rotor.node(bearing.shaft, bearing.station)
        stiffness[x : x + 2, x : x + 2] += np.array([[bearing.kxx, bearing.kxy], [bearing.kyx, bearing.kyy]], dtype=float)
        damping[x : x + 2, x : x + 2] += np.array([[bearing.cxx, bearing.cxy], [bearing.cyx, bearing.cyy]], dtype=float)
    for coupling in machine.couplings:
        ends = (4 * rotor.node(coupling.driver, machine.shaft(coupling.driver).length), 4 * rotor.node(coupling.driven, 0.0))
        k = np.zeros((4, 4))
        k[:2, :2] = [[coupling.kxx, coupling.kxy], [coupling.kyx, coupling.kyy]]
        k[2, 2], k[3, 3] = coupling.k_phix, coupling.k_phiy
        c = np.zeros((4, 4))
        c[:2, :2] = [[coupling.cxx, coupling.cxy], [coupling.cyx, coupling.cyy]]
        for i, row in enumerate(ends):
            for j, column in enumerate(ends):
                sign = 1 if i == j else -1
                stiffness[row : row + 4, column : column + 4] += sign * k
                damping[row : row + 4, column : column + 4] += sign * c
    return stiffness, damping


def dense_response(machine: Machine, speed: Floats, *, direction: int) -> Complexes:
    """Phasors (S, m) [m] of the nominal machine from the full dynamic stiffness, without any condensation.

    The force of an unbalance U = |U| e^{jβ} comes from where the heavy spot is: at (cos, sin) of direction·ωt + β.
    """
    rotor = assemble_rotor(machine)
    stiffness, damping = dense_elements(machine)
    result = np.empty((speed.size, len(machine.probes)), dtype=complex)
    for i, omega in enumerate(speed):
        force = np.zeros(rotor.size, dtype=complex)
        for disc in machine.discs:
            assert disc.unbalance is not None
            x = 4 * rotor.node(disc.shaft, disc.station)
            lead = direction * math.radians(disc.unbalance.angle_deg)
            phasor = disc.unbalance.magnitude * omega**2 * np.exp(1j * lead)
            # cos(ωt + lead) along x; along y direction·sin(ωt + lead), whose phasor is -j·direction.
            force[x] += phasor
            force[x + 1] += -1j * direction * phasor
        dynamic = rotor.stiffness + stiffness - omega**2 * rotor.mass
        dynamic = dynamic + 1j * omega * (damping + direction * omega * rotor.gyroscopic)
        displacement = np.linalg.solve(dynamic, force)
        for channel, probe in enumerate(machine.probes):
            x = 4 * rotor.node(probe.shaft, probe.station)
            angle = math.radians(probe.angle_deg)
            result[i, channel] = displacement[x] * math.cos(angle) + displacement[x + 1] * math.sin(angle)
    return result
