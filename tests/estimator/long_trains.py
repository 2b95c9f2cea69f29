"""Long trains that the reduction and the elimination are held against, each with something that is hard for them."""

import copy
import math

from benchmarks.documents import Document
from benchmarks.estimator.large_trains import large_train

SECTIONS = 60


def overhung() -> Document:
    """A heavy wheel beyond the last bearing, with strong gyroscopic moments, behind a stiff coupling."""
    document = large_train(SECTIONS, seed=3)
    end = math.fsum(section["length"] for section in document["shafts"][-1]["sections"])
    wheel = {"mass": 400.0, "diametral_inertia": 60.0, "polar_inertia": 110.0}
    document["discs"].append({"id": "overhung", "shaft": document["shafts"][-1]["id"], "station": end, **wheel})
    for coupling in document["couplings"]:
        coupling.update(kxx=1e9, kyy=1e9, k_phix=1e7, k_phiy=1e7)
    return document


def sealed() -> Document:
    """Seals with fluid inertia and a strong cross-coupling."""
    document = large_train(SECTIONS, seed=4)
    document["seals"] = [
        {"id": f"L{number}", "shaft": shaft["id"], "station": 1.1, "kxx": 2e7, "kxy": 1e7, "kyx": -1e7, "kyy": 2e7}
        | {"cxx": 2e4, "cxy": 3e3, "cyx": -3e3, "cyy": 2e4, "mxx": 60.0, "myy": 60.0}
        for number, shaft in enumerate(document["shafts"])
    ]
    return document


def damped_inside() -> Document:
    """Two materials of which one is damped inside, and external damping."""
    document = large_train(SECTIONS, seed=5)
    steel = document["materials"]["steel"]
    document["materials"]["sleeve"] = {**steel, "young_modulus": 1.2e11, "density": 7200.0, "internal_damping": 2e-5}
    for shaft in document["shafts"]:
        for section in shaft["sections"][::3]:
            section["material"] = "sleeve"
    document["damping"] = {"alpha": 0.5, "beta": 1e-5}
    return document


def following() -> Document:
    """Bearings that grow softer and less damped with the speed."""
    document = large_train(SECTIONS, seed=6)
    knots = {"form": "polynomial", "knots_rpm": [500, 2000, 4500]}
    for bearing in document["bearings"]:
        bearing["speed_dependence"] = copy.deepcopy(knots)
    return document


def plain() -> Document:
    """Sleeve bearings and flexible couplings."""
    return large_train(SECTIONS, seed=2)


TRAINS = {one.__name__: one for one in (plain, overhung, sealed, damped_inside, following)}
