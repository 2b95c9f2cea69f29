"""The trains that the benchmarks identify, their data, truth and Cramér-Rao bound.

Chapter 3 of the thesis, measured at its bearings only (150 speeds, 8 channels, 50 real unknowns; reference response of
tests/data, computed with ROSS), and `examples/turbine-compressor-generator.yaml` (290 speeds, 12 channels, 78 real unknowns
while E and density are known). Noise is circular complex, of an rms that is a part of each phasor's amplitude.
"""

import copy
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import yaml

from benchmarks.documents import Document
from estimator.arrays import Complexes, Floats
from estimator.fit.identification import Identification
from estimator.machine.document import Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response, sensitivity
from estimator.units import rpm_to_rad_per_s

EXAMPLES = Path(__file__).parents[2] / "examples"
REFERENCE = Path(__file__).parents[2] / "tests" / "data" / "thesis-chapter-3.npz"
COEFFICIENTS = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy", "k_phix", "k_phiy")


@dataclass(frozen=True)
class SimulatedTrain:
    """A document, its noiseless response (S, m) [m] at the speeds (S,) [rad/s] and its true real unknowns (N,) [SI]."""

    document: Document
    speed: Floats
    clean: Complexes
    truth: Floats

    @property
    def machine(self) -> Machine:
        """Return the machine of the document as it stands."""
        return parse_machine(self.document)

    def measured(self, seed: int, relative: float = 0.01) -> Measurement:
        """Return the response with noise."""
        rng = np.random.default_rng(seed)
        noise = rng.standard_normal(self.clean.shape) + 1j * rng.standard_normal(self.clean.shape)
        return Measurement.of(speed=self.speed, phasor=self.clean + relative / math.sqrt(2) * np.abs(self.clean) * noise)

    def stating(self, relative: float) -> "SimulatedTrain":
        """Return the train whose document states this relative noise and no floor."""
        return SimulatedTrain(
            {**self.document, "noise": {"relative": relative, "floor": 0.0}}, self.speed, self.clean, self.truth
        )


def two_shafts() -> SimulatedTrain:
    """Return the Chapter 3 train with the reference response."""
    document = yaml.safe_load((EXAMPLES / "thesis-chapter-3.yaml").read_text(encoding="utf-8"))
    with np.load(REFERENCE) as data:
        return SimulatedTrain(document, data["speed"][1::2], data["response"][1::2], _truth(parse_machine(document)))


def three_shafts(speeds: int = 290) -> SimulatedTrain:
    """Return the turbine, compressor and generator over their speed range, with the response of the model itself."""
    document = yaml.safe_load((EXAMPLES / "turbine-compressor-generator.yaml").read_text(encoding="utf-8"))
    document["noise"] = {"relative": 0.01, "floor": 0.0}
    document["materials"]["steel"].update(young_modulus_spread=0.0, density_spread=0.0)  # known: 78 unknowns, not 80
    machine = parse_machine(document)
    limits = machine.speed_range
    speed = np.linspace(rpm_to_rad_per_s(limits.minimum_rpm), rpm_to_rad_per_s(limits.maximum_rpm), speeds)
    return SimulatedTrain(document, speed, modelled(machine, speed), _truth(machine))


def modelled(machine: Machine, speed: Floats) -> Complexes:
    """Return the response of a machine at its document's values."""
    train = condense(machine, speed=speed, direction=np.ones_like(speed))
    coefficients = np.array([one.nominal for one in train.unknowns.coefficients], dtype=float)
    excitations = np.array([one.nominal for one in train.unknowns.excitations], dtype=complex)
    return response(train, coefficients=coefficients, excitations=excitations)


def off(document: Document, rng: np.random.Generator, span: float) -> Document:
    """Return the document with every nominal coefficient off by a factor uniform between 1 ± span, and no nominal
    unbalance."""
    changed = copy.deepcopy(document)
    for part in (*changed["bearings"], *changed["couplings"]):
        for name in COEFFICIENTS:
            if name in part:
                part[name] *= 1 + rng.uniform(-span, span)
    for disc in changed["discs"]:
        disc.pop("unbalance", None)
    return changed


def silent(document: Document, kinds: tuple[str, ...]) -> Document:
    """Return the document without nominal values of its bearings, or couplings, or discs' unbalances."""
    left_out = {*COEFFICIENTS, "unbalance"}
    return {
        **document,
        **{kind: [{k: v for k, v in part.items() if k not in left_out} for part in document[kind]] for kind in kinds},
    }


def cramer_rao(train: SimulatedTrain, relative: float) -> Floats:
    """Return the smallest standard error (N,) that an unbiased estimate of each real unknown can have."""
    machine = train.machine
    condensed = condense(machine, speed=train.speed, direction=np.ones_like(train.speed))
    count = len(condensed.unknowns.coefficients)
    parts = train.truth[count:].reshape(-1, 2)
    found = sensitivity(condensed, coefficients=train.truth[:count], excitations=parts[:, 0] + 1j * parts[:, 1])
    weighted = found.by_parameter / (relative / math.sqrt(2) * np.abs(train.clean))[..., None]
    columns = weighted.reshape(-1, weighted.shape[-1])
    size = np.linalg.norm(columns, axis=0)
    information = ((columns / size).conj().T @ (columns / size)).real
    return np.asarray(np.sqrt(np.diag(np.linalg.inv(information))) / size)


def values(found: Identification) -> tuple[Floats, Floats, Floats]:
    """Return estimates (N,), and lower and upper end of their 95 % intervals; NaN where not estimable."""
    rows: list[tuple[float, float, float]] = []
    for one in found.estimates:
        if one.quantity in ("scale factor", "gain", "run-out"):
            continue
        parts = [(one.value, one.standard_error)]
        if one.quantity == "unbalance":
            parts.append((one.imaginary, one.imaginary_standard_error))
            rows += [(v, v - 1.96 * e, v + 1.96 * e) if v is not None and e is not None else (math.nan,) * 3 for v, e in parts]
        elif one.value is None or one.lower is None or one.upper is None:
            rows.append((math.nan,) * 3)
        else:
            rows.append((one.value, one.lower, one.upper))
    table = np.array(rows)
    return table[:, 0], table[:, 1], table[:, 2]


def _truth(machine: Machine) -> Floats:
    unknown = condense(machine, speed=np.array([1.0]), direction=np.array([1.0])).unknowns
    unbalances = np.array([one.nominal for one in unknown.unbalances], dtype=complex)
    parts = np.stack([unbalances.real, unbalances.imag], axis=-1).reshape(-1)
    return np.concatenate([np.array([one.nominal for one in unknown.coefficients], dtype=float), parts])
