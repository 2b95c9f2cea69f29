"""The motor and compressor of tests/data/motor-compressor, whose reference arrays another program has computed."""

import json
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from tests.film_plant.train import Bearing, ConstantOil, Coupling, Disc, Material, Shaft, Train
from tests.paths import DATA

CouplingKind = Literal["flexible", "rigid"]
CASES = ("aligned", "parallel_down", "parallel_up", "angle_100urad", "oil_warm", "worn_B2")
"""Cases of the arrays."""
PARALLEL = {"flexible": 100e-6, "rigid": 25e-6}
"""Parallel offset of the second shaft's bearings [m]."""
ANGLE = 100e-6
"""Angle of the second shaft's bearings [rad]."""


def motor_compressor(kind: CouplingKind, case: str = "aligned") -> Train:
    """The train with a coupling of a kind, in one of the cases."""
    said = json.loads((DATA / "motor-compressor" / "train.json").read_text())
    shafts = tuple(Shaft(tuple(map(tuple, one["elements_length_diameter"]))) for one in said["shafts"])
    places = [np.cumsum([0.0, *(length for length, _ in shaft.pieces)]) for shaft in shafts]
    discs = tuple(
        Disc(
            one["shaft"],
            float(places[one["shaft"]][one["node"]]),
            one["mass"],
            one["diametral_inertia"],
            one["polar_inertia"],
            complex(one["unbalance_kg_m"] * np.exp(1j * np.radians(one["unbalance_deg"]))),
        )
        for one in said["discs"]
    )
    bearings = tuple(
        _bearing(one, float(places[one["shaft"]][one["node"]]), elevation)
        for one, elevation in zip(said["bearings"], said[kind]["elevation_m"], strict=True)
    )
    half = said["coupling_half"]
    terms = said[kind]["coupling"]
    coupling = Coupling(
        np.array([[terms["kxx"], terms["kxy"]], [terms["kyx"], terms["kyy"]]]),
        np.array([[terms["cxx"], terms["cxy"]], [terms["cyx"], terms["cyy"]]]),
        terms["k_phix"],
        terms["k_phiy"],
        (half["mass"], half["diametral_inertia"], half["polar_inertia"]),
    )
    train = Train(shafts, discs, bearings, (coupling,), Material(**said["material"]), said["gravity"])
    return changed(train, kind, case)


def _bearing(said: dict[str, Any], station: float, elevation: float) -> Bearing:
    return Bearing(
        said["shaft"],
        station,
        said["diameter"],
        said["length"],
        said["radial_clearance"],
        ConstantOil(said["viscosity"]),
        elevation=(0.0, elevation),
    )


def changed(train: Train, kind: CouplingKind, case: str) -> Train:
    """The train in a case: misaligned, with warm oil or with a worn bearing."""
    b1, b2, *second = train.bearings
    if case == "aligned":
        return train
    if case in ("parallel_down", "parallel_up"):
        rise = PARALLEL[kind] * (1.0 if case == "parallel_up" else -1.0)
        return replace(train, bearings=(b1, b2, *(_raised(one, rise) for one in second)))
    if case == "angle_100urad":
        return replace(train, bearings=(b1, b2, *(_raised(one, -ANGLE * one.station) for one in second)))
    if case == "oil_warm":
        return replace(train, bearings=tuple(replace(one, oil=ConstantOil(0.85 * _viscosity(one))) for one in train.bearings))
    if case == "worn_B2":
        return replace(train, bearings=(b1, replace(b2, clearance=1.3 * b2.clearance), *second))
    raise ValueError(f"no case '{case}', but {', '.join(CASES)}")


def _raised(bearing: Bearing, rise: float) -> Bearing:
    return replace(bearing, elevation=(bearing.elevation[0], bearing.elevation[1] + rise))


def _viscosity(bearing: Bearing) -> float:
    return bearing.oil.viscosity(bearing, speed=0.0, eccentricity=0.0)
