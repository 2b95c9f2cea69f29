"""Young's modulus and density as nuisance parameters, against trains whose document says other values of them."""

import copy

import numpy as np
import pytest

from estimator.fit.identification import Options
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import Sensitivity, sensitivity
from tests.estimator.full_train import deviations, full_response, true_values, two_material_document
from tests.estimator.trains import Document, Floats, chapter_3_document, noisy, truth

SPEED: Floats = np.arange(10.0, 300.0, 2.0)
SPARSE: Floats = np.array([15.0, 83.0, 170.0, 283.0, 520.0])
BOTH = {"young_modulus_spread": 0.05, "density_spread": 0.05}


def scaled(document: Document, factors: dict[str, float]) -> Document:
    """A copy of a document whose materials have other values: factors by name, such as material.steel.density."""
    changed = copy.deepcopy(document)
    for name, factor in factors.items():
        _, material, what = name.split(".")
        changed["materials"][material][what] *= factor
    return changed


def damped(document: Document) -> Document:
    document["damping"] = {"alpha": 3.0, "beta": 2e-5}
    for i, material in enumerate(document["materials"].values()):
        material["internal_damping"] = 1e-5 * (i + 1)
    return document


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("with_damping", [False, True], ids=["undamped shafts", "damped shafts"])
def test_derivatives_by_the_logarithms_of_the_factors(direction: int, with_damping: bool) -> None:
    document = two_material_document(chapter_3_document())
    if with_damping:
        damped(document)
    for material in document["materials"].values():
        material.update(BOTH)
    document["shafts"][1]["bow_spread"] = 1e-4  # its force goes with E
    document["couplings"][0]["load"] = {"force_spread": 10.0, "moment_spread": 1.0}  # its does not
    machine = parse_machine(document)
    train = condense(machine, speed=SPARSE, direction=np.full(SPARSE.size, float(direction)))
    coefficients, unbalances = truth(machine)
    others = np.array([2e-4 * np.exp(0.7j), 30.0, 20j, 1.0 - 1j, 2.0])  # bow, two forces, two moments
    excitations = np.concatenate([unbalances, others])
    names = train.scale_names
    assert names == tuple(f"material.{m}.{w}" for m in ("steel", "titanium") for w in ("young_modulus", "density"))

    def phasors(factors: Floats) -> Sensitivity:
        return sensitivity(train.scaled(factors), coefficients=coefficients, excitations=excitations)

    at = np.array([1.03, 0.96, 0.9, 1.2])
    found = phasors(at)
    step = 1e-5
    for k in range(len(names)):
        up, down = at.copy(), at.copy()
        up[k] *= np.exp(step)
        down[k] *= np.exp(-step)
        expected = (phasors(up).phasor - phasors(down).phasor) / (2 * step)
        assert np.abs(found.by_scale[k] - expected).max() < 1e-6 * np.abs(expected).max(), names[k]


@pytest.mark.parametrize("direction", [1, -1])
def test_scaled_train_is_the_train_of_a_scaled_document(direction: int) -> None:
    document = damped(two_material_document(chapter_3_document()))
    for material in document["materials"].values():
        material.update(BOTH)
    machine = parse_machine(document)
    train = condense(machine, speed=SPARSE, direction=np.full(SPARSE.size, float(direction)))
    factors = np.array([1.03, 0.96, 0.9, 1.2])
    coefficients, unbalances = truth(machine)
    found = sensitivity(train.scaled(factors), coefficients=coefficients, excitations=unbalances).phasor
    other = parse_machine(scaled(document, dict(zip(train.scale_names, factors.tolist(), strict=True))))
    expected = full_response(other, SPARSE, direction=direction)
    assert np.abs(found - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize(
    "signs",
    [(1, 1), *(pytest.param(one, marks=pytest.mark.long) for one in ((1, -1), (-1, 1))), (-1, -1)],
    ids=["E+ ρ+", "E+ ρ-", "E- ρ+", "E- ρ-"],
)
def test_rotor_five_per_cent_off(signs: tuple[int, int]) -> None:
    names = ("material.steel.young_modulus", "material.steel.density")
    factors = {name: 1.0 + 0.05 * sign for name, sign in zip(names, signs, strict=True)}
    document = chapter_3_document()
    real = parse_machine(scaled(document, factors))
    measurement = Measurement.of(speed=SPEED, phasor=noisy(full_response(real, SPEED), seed=5))
    fixed = identify(parse_machine(document), measurement, Options(starts=1))
    assert not fixed.accepted

    document["materials"]["steel"].update(BOTH)
    found = identify(parse_machine(document), measurement)
    assert found.accepted, found.verdict
    assert abs(found.chi_square / found.degrees_of_freedom - 1) < 5 * np.sqrt(2 / found.degrees_of_freedom)
    values = true_values(real)
    errors = [abs((one.value or 0.0) - values[one.name].real) / abs(values[one.name]) for one in found.estimates[:42]]
    assert np.median(errors) < 0.02
    assert np.abs(deviations(found, dict(factors))).max() < 4.0
    assert np.abs(deviations(found, values)).max() < 4.5  # the largest of 50


def test_two_materials_off_in_opposite_senses() -> None:
    document = two_material_document(chapter_3_document())
    factors = {
        "material.steel.young_modulus": 1.04,
        "material.steel.density": 0.97,
        "material.titanium.young_modulus": 0.95,
        "material.titanium.density": 1.05,
    }
    real = parse_machine(scaled(document, factors))
    backward = Measurement.of(speed=SPEED, phasor=noisy(full_response(real, SPEED, direction=-1), seed=2), direction=-1.0)
    for material in document["materials"].values():
        material.update(BOTH)
    found = identify(parse_machine(document), backward)
    assert found.accepted, found.verdict
    assert np.abs(deviations(found, dict(factors))).max() < 4.0
    assert np.abs(deviations(found, true_values(real))).max() < 4.5


def test_only_the_factor_asked_for_is_estimated() -> None:
    document = chapter_3_document()
    document["materials"]["steel"]["density_spread"] = 0.05
    machine = parse_machine(document)
    found = identify(machine, Measurement.of(speed=SPEED, phasor=noisy(full_response(machine, SPEED), seed=0)))
    assert [one.name for one in found.estimates if one.quantity == "scale factor"] == ["material.steel.density"]
    assert len(found.coordinates) == 51
