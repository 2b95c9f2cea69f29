"""The example documents: that they are machines, that the thesis's rig has its printed frequencies, and that a run-down of the
industrial trains determines their bearings and couplings.

The simulated machine differs from its document by a tenth (standard deviation of the logarithm of each coefficient), its
unbalances lie anywhere; its phasors carry the document's noise, 1 % of the amplitude and a floor. The errors of one fit are
correlated, so their rms is asked of several machines together.
"""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml

from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import Machine, parse_machine
from estimator.modes.critical_speed import critical_speeds
from estimator.modes.eigenmodes import eigenvalues, natural_frequencies
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from estimator.rotor.response import response
from estimator.simulation.simulated_plant import noise
from estimator.units import rad_per_s_to_rpm, rpm_to_rad_per_s
from tests.estimator.trains import ROOT, Complexes, Floats, truth

EXAMPLES = sorted((ROOT / "examples").glob("*.yaml"))
RIG = "thesis-chapter-5-rig"
EACH_TRAIN = pytest.mark.parametrize("name", ["motor-pump", "turbine-compressor-generator"])
SEEDS = range(5)
SPEEDS = 200
ROUNDING = 1e-9
"""Growth, relative to |λ|, that rounding alone can show in a mode without damping."""


def example(name: str) -> Machine:
    """The machine of an example document."""
    return parse_machine(yaml.safe_load((ROOT / "examples" / f"{name}.yaml").read_text(encoding="utf-8")))


def damping_ratios(machine: Machine, *, spin: float, highest: float = math.inf) -> Floats:
    """-Re λ / |λ| of the modes up to a frequency [rad/s]."""
    roots = eigenvalues(machine, spin=machine.direction * spin)
    roots = roots[roots.imag <= highest]
    return np.asarray(-roots.real / np.abs(roots))


def spins(machine: Machine) -> Floats:
    """Spin speeds [rad/s] from standstill to the top of the speed range."""
    return np.linspace(0.0, rpm_to_rad_per_s(machine.speed_range.maximum_rpm), 7)


# --- the documents ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_every_example_is_a_machine_under_its_own_name(path: Path) -> None:
    machine = parse_machine(yaml.safe_load(path.read_text(encoding="utf-8")))
    assert (machine.plant, machine.id) == ("examples", path.stem)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_no_example_is_unstable_within_its_speed_range(path: Path) -> None:
    machine = example(path.stem)
    assert min(damping_ratios(machine, spin=spin).min() for spin in spins(machine)) > -ROUNDING


@EACH_TRAIN
def test_a_train_is_damped_as_sleeve_bearings_damp(name: str) -> None:
    machine = example(name)
    top = rpm_to_rad_per_s(machine.speed_range.maximum_rpm)
    assert min(damping_ratios(machine, spin=spin, highest=top).min() for spin in spins(machine)) > 0.03


@EACH_TRAIN
def test_a_train_crosses_a_critical_speed_for_each_bearing(name: str) -> None:
    machine = example(name)
    assert critical_speeds(machine, highest=rpm_to_rad_per_s(machine.speed_range.maximum_rpm)).size >= len(machine.bearings)


# --- laboratory rigs --------------------------------------------------------------------------------------------------


def test_the_rig_has_the_frequencies_of_the_impact_test() -> None:
    """150, 203 to 205 and 363 Hz (thesis Table 5.6, without misalignment), one in each plane; 2 % for anisotropy."""
    found = natural_frequencies(example(RIG))[:6] / (2 * math.pi)
    assert found == pytest.approx(np.repeat([150.0, 204.0, 363.0], 2), rel=0.02)


@pytest.mark.parametrize(("shaft", "printed"), [("S1", 373.0), ("S2", 169.0)])
def test_the_rig_has_the_frequencies_of_appendix_c(shaft: str, printed: float) -> None:
    """√(48EI/L³/m)/2π of a massless, simply supported shaft with a disc at mid span (thesis Eq. C.1, C.2); 0.5 %."""
    machine = example(RIG)
    section = max(machine.shaft(shaft).sections, key=lambda one: one.length)
    second_moment = math.pi / 64 * section.outer_diameter**4
    near, far = (bearing.station for bearing in machine.bearings if bearing.shaft == shaft)
    stiffness = 48 * machine.materials[section.material].young_modulus * second_moment / (far - near) ** 3
    disc = next(one for one in machine.discs if one.shaft == shaft)
    assert disc.station == pytest.approx((near + far) / 2)
    assert math.sqrt(stiffness / disc.mass) / (2 * math.pi) == pytest.approx(printed, rel=0.005)


@pytest.mark.parametrize(("disc", "density", "diameter"), [("D1", 2600.0, 0.18), ("D2", 7800.0, 0.13)])
def test_the_rig_has_discs_whose_inertia_fits_their_mass(disc: str, density: float, diameter: float) -> None:
    """Discs of the printed mass, width (10 mm) and density; printed diameters (10 and 12 mm) cannot have that mass."""
    one = next(item for item in example(RIG).discs if item.id == disc)
    square = 4 * one.mass / (math.pi * density * 0.01)
    assert math.sqrt(square) == pytest.approx(diameter, rel=0.02)
    assert one.polar_inertia == pytest.approx(one.mass * square / 8, rel=0.01)
    assert one.diametral_inertia == pytest.approx(one.mass * (square / 16 + 0.01**2 / 12), rel=0.01)


def test_the_rotor_kit_has_its_measured_critical_speed() -> None:
    """1648 rpm in the recorded run-up; 2 %."""
    first = critical_speeds(example("rk4-rotor-kit"), highest=rpm_to_rad_per_s(2000))[0]
    assert rad_per_s_to_rpm(first) == pytest.approx(1648, rel=0.02)


# --- identification of the trains ---------------------------------------------------------------------------------------


def real_machine(machine: Machine, rng: np.random.Generator) -> tuple[Floats, Complexes]:
    """Coefficients (K,) and unbalances (P,) of a machine built after the document."""
    coefficients, unbalances = truth(machine)
    spread = np.exp(0.1 * rng.standard_normal(coefficients.size))
    size = np.exp(0.5 * rng.standard_normal(unbalances.size))
    return coefficients * spread, unbalances * size * np.exp(1j * rng.uniform(-math.pi, math.pi, unbalances.size))


def identified(machine: Machine, seed: int) -> tuple[Identification, Floats]:
    """Return what one noisy run-down tells of a real machine, and the errors of its estimates in standard errors."""
    rng = np.random.default_rng(seed)
    speed_range = machine.speed_range
    speed = np.linspace(rpm_to_rad_per_s(speed_range.minimum_rpm), rpm_to_rad_per_s(speed_range.maximum_rpm), SPEEDS)
    train = condense(machine, speed=speed, direction=np.full(SPEEDS, float(machine.direction)))
    coefficients, unbalances = real_machine(machine, rng)
    factors = np.exp(train.scale_spread * rng.standard_normal(train.scale_spread.size))
    clean = response(train.scaled(factors), coefficients=coefficients, excitations=unbalances)
    measured = Measurement.of(speed=speed, phasor=clean + noise(machine.noise, clean, rng), direction=machine.direction)
    found = identify(machine, measured)
    pairs = zip(found.estimates, [*coefficients, *unbalances, *factors], strict=True)
    return found, np.concatenate([normalised_errors(one, value) for one, value in pairs])


def normalised_errors(estimate: Estimate, value: complex) -> Floats:
    """The estimate's errors in standard errors: none, one, or an unbalance's two. Direct terms are judged by logarithms."""
    if estimate.value is None or estimate.standard_error is None:
        return np.empty(0)
    if estimate.imaginary is not None and estimate.imaginary_standard_error is not None:
        imaginary = (estimate.imaginary - value.imag) / estimate.imaginary_standard_error
        return np.array([(estimate.value - value.real) / estimate.standard_error, imaginary])
    if estimate.name.endswith(("xy", "yx")):
        return np.array([(estimate.value - value.real) / estimate.standard_error])
    return np.array([math.log(estimate.value / value.real) / relative_error(estimate)])


def relative_error(estimate: Estimate) -> float:
    """Standard error over value of a direct term; infinite where the data do not determine it."""
    if estimate.value is None or estimate.standard_error is None:
        return math.inf
    return estimate.standard_error / estimate.value


def worst(found: Identification, kind: str) -> float:
    """Largest relative standard error of the direct stiffnesses kxx and kyy of all bearings or couplings."""
    direct = [one for one in found.estimates if one.element.startswith(kind) and one.name.endswith(("kxx", "kyy"))]
    return max(relative_error(one) for one in direct)


@EACH_TRAIN
def test_a_run_down_determines_a_train(name: str) -> None:
    machine = example(name)
    results = [identified(machine, seed) for seed in SEEDS]
    for found, _ in results:
        assert found.accepted, found.verdict
        assert worst(found, "bearing.") < 0.02
        assert worst(found, "coupling.") < 0.05
    errors = np.concatenate([error for _, error in results])
    assert 0.7 < math.sqrt(np.mean(errors**2)) < 1.3
    assert np.abs(errors).max() < 5.0
