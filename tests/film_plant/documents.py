"""Machine documents and measurements of film plants: the only place where they meet the estimator."""

from collections.abc import Iterator, Sequence
from typing import Any, Literal

import numpy as np

from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import MeasuredGaps, Measurement
from tests.film_plant.arrays import Complexes, Floats
from tests.film_plant.oil import HeatedOil
from tests.film_plant.plant import NOISE_FLOOR, NOISE_PART, RPM, Plant, noisy
from tests.film_plant.plants import PRIORS, SUPPORT_SPREAD, Priors
from tests.film_plant.statics import Equilibrium
from tests.film_plant.supports import OwnCoefficients
from tests.film_plant.tilting import TILTING
from tests.film_plant.train import Bearing, Pedestal

Form = Literal["constant", "polynomial", "piecewise"]

DIRECT = ("kxx", "kyy", "cxx", "cyy")
"""Direct terms of a bearing."""
STIFFNESS, DAMPING = ("kxx", "kxy", "kyx", "kyy"), ("cxx", "cxy", "cyx", "cyy")
"""Terms of a bearing in the order of its matrices."""
PERTURBATION = 0.15
"""Standard deviation by which nominal coefficients are off: of the logarithm, or part of the value [-]."""
FILM_DISCREPANCY = 0.05
"""Rms of the films' deviations that documents state: some 4 % are drawn, and solvers differ by 1 or 2 % [-]."""
BORES: dict[str, dict[str, Any]] = {
    "plain": {"profile": "plain"},
    "grooved": {"profile": "two_axial_grooves", "groove_deg": 20.0},
    "elliptical": {"profile": "elliptical", "groove_deg": 20.0, "preload": 0.5},
    "three_lobe": {"profile": "three_lobe", "groove_deg": 20.0, "preload": 0.4},
    "four_lobe": {"profile": "four_lobe", "groove_deg": 20.0, "preload": 0.4},
}
"""Bores of the plant as documents describe them."""
SLOPE_SPREAD = 0.15
"""Prior standard deviation of the slope of viscosity over speed that documents of warmed oil state [-]."""
RIGID = 1e8
"""Lateral stiffness from which on a coupling is a rigid one [N/m]."""
GAP_NOISE, GAP_DRIFT, GAP_ZERO = 1e-6, 5e-6, 1e-3
"""Rms noise of a gap, drift of a probe's zero over a run, and that zero [m]."""
RUN_S = 600.0
"""Time that a run takes [s]."""
SPEED_MARGIN = 0.02
"""Part by which a document's speed range is wider than the runs [-]."""


def linear_document(
    plant: Plant,
    *,
    form: Form = "constant",
    knots_rpm: Sequence[float] = (),
    terms: Literal["direct", "all"] = "direct",
    perturbation: float = PERTURBATION,
    seed: int = 0,
    unbalances_given: bool = True,
    element_length: float | None = None,
) -> dict[str, Any]:
    """The document that describes a plant's bearings by eight linear coefficients each.

    Args:
        plant: The plant.
        form: How the coefficients follow the speed.
        knots_rpm: Knots of the forms that do [r/min].
        terms: Which terms follow it.
        perturbation: How far nominal coefficients, coupling and unbalances are from the true ones at the median speed [-].
        seed: Seed of the perturbations.
        unbalances_given: Whether nominal unbalances stand in it.
        element_length: Longest element of the document's mesh [m]; None for the default.

    Returns:
        The document.
    """
    rng = np.random.default_rng(seed)
    said = geometry(plant)
    films = plant.films(np.array([(plant.slowest + plant.fastest) / 2]))
    for bearing, k, c in zip(said["bearings"], films.stiffness[0], films.damping[0], strict=True):
        bearing |= _perturbed(zip(STIFFNESS + DAMPING, [*k.ravel(), *c.ravel()], strict=True), perturbation, rng)
        if form != "constant":
            bearing["speed_dependence"] = {"form": form, "knots_rpm": list(knots_rpm)}
            if terms == "direct":
                bearing["speed_dependence"]["coefficients"] = list(DIRECT)
    for coupling in said["couplings"]:
        lateral = [(name, coupling[name]) for name in (*STIFFNESS, *DAMPING, "k_phix", "k_phiy")]
        coupling |= _perturbed(lateral, perturbation, rng)
    for disc, true in zip(said["discs"], plant.train.discs, strict=True):
        error = perturbation * (rng.standard_normal() + 1j * rng.standard_normal())
        off = true.unbalance * (1.0 + error)
        if unbalances_given:
            disc["unbalance"] = {"magnitude": float(abs(off)), "angle_deg": float(np.degrees(np.angle(off)))}
    if element_length is not None:
        said["element_length"] = element_length
    return said


def film_document(plant: Plant, *, priors: Priors = PRIORS, discrepancy: float = FILM_DISCREPANCY) -> dict[str, Any]:
    """The document that describes a plant's bearings by their films as they are believed, with the priors on them."""
    said = geometry(plant)
    rigid = any(one["kxx"] > RIGID for one in said["couplings"])
    for bearing, one in zip(said["bearings"], plant.believed.bearings, strict=True):
        if one.own is not None:
            bearing |= _own_coefficients(one.own) | {
                "elevation": {"spread": priors.rigid_elevation if rigid else priors.elevation}
            }
            continue
        bearing["film"] = {
            "diameter": one.diameter,
            "length": one.length,
            "radial_clearance": one.clearance,
            "oil": _oil(one),
            **_bore(one.profile),
        }
        bearing["speed_dependence"] = {
            "form": "journal",
            "clearance_spread": priors.clearance,
            "viscosity_spread": priors.viscosity,
            "elevation_spread": priors.rigid_elevation if rigid else priors.elevation,
            "discrepancy": discrepancy,
        }
        if priors.common_oil:
            bearing["film"]["oil"]["supply"] = "main"
            bearing["speed_dependence"]["viscosity_ratio_spread"] = priors.viscosity_difference
        if isinstance(one.oil, HeatedOil):
            bearing["speed_dependence"]["viscosity_slope_spread"] = SLOPE_SPREAD
    rules = [
        {"names": f"bearing.B{number}.{term}", "spread": SUPPORT_SPREAD}
        for number, one in enumerate(plant.believed.bearings, start=1)
        if one.own is not None and one.own.constant
        for term in DIRECT
    ]
    return said | ({"parameters": rules} if rules else {})


def without_run_scatter(document: dict[str, Any]) -> dict[str, Any]:
    """The document of a train whose films are the same in all runs."""
    return document | {"operation": {"healthy_variation": {"damping": 0.0}}}


def _own_coefficients(own: OwnCoefficients) -> dict[str, Any]:
    """The coefficients of a bearing that is no film, as they are believed: a number each, or a table over speed."""
    values = np.concatenate([own.stiffness.reshape(-1, 4), own.damping.reshape(-1, 4)], axis=1).T
    named = dict(zip(STIFFNESS + DAMPING, values.tolist(), strict=True))
    if own.constant:
        return {name: value for name, (value,) in named.items()}
    table = {"form": "table", "speed_rpm": (own.speed / RPM).tolist(), "scale_spread": SUPPORT_SPREAD}
    return {"speed_dependence": table | named}


def _oil(bearing: Bearing) -> dict[str, Any]:
    """A bearing's oil as it is believed: of one viscosity, or warmed from the temperature at which it comes."""
    if isinstance(bearing.oil, HeatedOil):
        return {"iso_vg": bearing.oil.grade, "inlet_c": bearing.oil.inlet}
    return {"viscosity": float(bearing.oil.viscosity(bearing, speed=0.0, eccentricity=0.0))}


def _bore(profile: str) -> dict[str, Any]:
    """A bore of the plant, or tilting pads, as documents describe them."""
    pads = TILTING.get(profile)
    if pads is None:
        return BORES[profile]
    said = {"number": pads.count, "arc_deg": float(np.degrees(pads.arc)), "pivot": pads.pivot, "load": "between_pads"}
    return {"profile": "tilting_pad", "preload": pads.preload, "pads": said}


def with_pedestals(said: dict[str, Any], plant: Plant, *, spread: float, seed: int = 0) -> dict[str, Any]:
    """The document with the plant's pedestals, each number off by a spread of its logarithm, which is its prior."""
    rng = np.random.default_rng(9000 + seed)
    pedestals = [
        {
            "id": f"P{number}",
            "bearing": f"B{number}",
            **{name: float(value * np.exp(spread * rng.standard_normal())) for name, value in pedestal_terms(one.pedestal)},
        }
        for number, one in enumerate(plant.train.bearings, start=1)
        if one.pedestal is not None
    ]
    rule = {"names": "pedestal.*", "fixed": True} if spread == 0.0 else {"names": "pedestal.*", "spread": spread}
    probes = [one | {"absolute": plant.absolute} for one in said["probes"]]
    return said | {"pedestals": pedestals, "parameters": [rule], "probes": probes}


def pedestal_terms(one: Pedestal) -> Iterator[tuple[str, float]]:
    """Names and values of a pedestal's coefficients [SI]."""
    for letter, (x, y) in (("k", one.stiffness), ("c", one.damping), ("m", one.mass)):
        yield f"{letter}xx", x
        yield f"{letter}yy", y


def geometry(plant: Plant) -> dict[str, Any]:
    """Return what any document of a plant says, without its bearings' coefficients: they are named by shaft and station
    only."""
    train = plant.believed
    steel = train.material
    return {
        "schema_version": 1,
        "id": plant.name.replace(" ", "-"),
        "plant": "films",
        "name": plant.name,
        "speed_range": {
            "minimum_rpm": float(plant.slowest / RPM * (1.0 - SPEED_MARGIN)),
            "maximum_rpm": float(plant.fastest / RPM * (1.0 + SPEED_MARGIN)),
        },
        "materials": {"steel": {"young_modulus": steel.young, "density": steel.density, "poisson_ratio": steel.poisson}},
        "shafts": [
            {
                "id": f"S{number}",
                "sections": [
                    {"length": length, "outer_diameter": diameter, "material": "steel"} for length, diameter in shaft.pieces
                ],
            }
            for number, shaft in enumerate(train.shafts, start=1)
        ],
        "discs": [
            {
                "id": f"D{number}",
                "shaft": f"S{disc.shaft + 1}",
                "station": disc.station,
                "mass": disc.mass,
                "diametral_inertia": disc.diametral_inertia,
                "polar_inertia": disc.polar_inertia,
            }
            for number, disc in enumerate(train.discs, start=1)
        ],
        "bearings": [
            {"id": f"B{number}", "shaft": f"S{one.shaft + 1}", "station": one.station}
            for number, one in enumerate(train.bearings, start=1)
        ],
        "couplings": [_coupling(plant, number) for number in range(len(train.couplings))],
        "probes": [
            {"id": f"B{number}{axis}", "shaft": f"S{one.shaft + 1}", "station": one.station, "angle_deg": angle}
            for number, one in enumerate(train.bearings, start=1)
            for axis, angle in (("X", 0.0), ("Y", 90.0))
        ],
        "noise": {"relative": NOISE_PART, "floor": NOISE_FLOOR},
    }


def _coupling(plant: Plant, number: int) -> dict[str, Any]:
    """The coupling behind shaft `number` with its true coefficients and halves."""
    one = plant.train.couplings[number]
    values = zip(STIFFNESS + DAMPING, [*one.stiffness.ravel(), *one.damping.ravel()], strict=True)
    mass, diametral, polar = one.half
    half = {"mass": mass, "diametral_inertia": diametral, "polar_inertia": polar}
    return {
        "id": f"C{number + 1}",
        "driver": f"S{number + 1}",
        "driven": f"S{number + 2}",
        **{name: float(value) for name, value in values},
        "k_phix": one.k_phix,
        "k_phiy": one.k_phiy,
        "driver_half": half,
        "driven_half": half,
    }


def _perturbed(values: Any, size: float, rng: np.random.Generator) -> dict[str, float]:
    """Coefficients with their errors: of the logarithm of direct terms, else a part of the value."""
    found = {}
    for name, value in values:
        error = size * rng.standard_normal()
        direct = name in DIRECT or name.startswith("k_phi")
        found[name] = float(value * (np.exp(error) if direct else 1.0 + error))
    return found


def linear_machine(plant: Plant, **options: Any) -> Machine:
    """The machine of `linear_document`, with its options."""
    return parse_machine(linear_document(plant, **options))


def measured(plant: Plant, *, samples: int = 150, seed: int = 0, clean: tuple[Floats, Complexes] | None = None) -> Measurement:
    """Noisy steady phasors of a run-down, or of speeds (S,) [rad/s] and phasors (S, m) [m] that are given."""
    if clean is None:
        films = plant.films(plant.speeds(samples))
        clean = films.speed, plant.phasors(films)
    speed, phasor = clean
    return Measurement.of(speed=speed, phasor=noisy(phasor, np.random.default_rng(seed)))


def measured_gaps(films: Equilibrium, rng: np.random.Generator) -> MeasuredGaps:
    """Gaps of a run at the films' speeds, one after the other: where the journals stand, from zeros that drift steadily."""
    place = films.position.reshape(films.speed.size, -1)
    count, channels = place.shape
    elapsed = np.linspace(0.0, 1.0, count)
    zero = GAP_ZERO * rng.standard_normal(channels) + GAP_DRIFT * rng.standard_normal(channels) * elapsed[:, None]
    return MeasuredGaps(place + zero + GAP_NOISE * rng.standard_normal(place.shape), RUN_S * elapsed, np.zeros(count, np.intp))
