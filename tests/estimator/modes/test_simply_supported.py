"""Simply supported shafts: textbook limits, the finite-element model as a second opinion, and the thesis's Appendix C."""

import math

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import natural_frequencies
from estimator.modes.simply_supported import (
    SimplySupportedShaft,
    Theory,
    Whirl,
    disc_at_midspan_frequency,
    natural_frequency,
    span_for,
)
from tests.estimator.trains import one_disc_document

STEEL = 2.1e11
SHAFT = SimplySupportedShaft(span=1.0, outer_diameter=0.12, young_modulus=STEEL, density=7800.0)
THEORIES: tuple[Theory, ...] = ("Euler-Bernoulli", "Rayleigh", "Timoshenko")
WHIRLS: tuple[Whirl, ...] = ("forward", "backward")


def test_euler_bernoulli_is_the_textbook_formula() -> None:
    """ω = (nπ/L)² √(EI/ρA), with √(I/A) = d/4 of a solid circle."""
    for mode in (1, 2, 3):
        expected = (mode * math.pi) ** 2 * 0.12 / 4 * math.sqrt(STEEL / 7800.0)
        assert natural_frequency(SHAFT, mode=mode, theory="Euler-Bernoulli", spin=500.0) == pytest.approx(expected, rel=1e-12)


def test_rotary_inertia_and_shear_lower_the_frequencies_at_rest() -> None:
    """Rayleigh's ω is Euler-Bernoulli's over √(1 + (nπd/4L)²); Timoshenko's is lower still."""
    for mode in (1, 2, 3):
        euler, rayleigh, timoshenko = (natural_frequency(SHAFT, mode=mode, theory=theory) for theory in THEORIES)
        assert rayleigh == pytest.approx(euler / math.sqrt(1 + (mode * math.pi * 0.12 / 4) ** 2), rel=1e-10)
        assert timoshenko < rayleigh


@pytest.mark.parametrize("theory", THEORIES)
def test_a_slender_shaft_follows_the_simplest_theory(theory: Theory) -> None:
    slender = SimplySupportedShaft(span=1.0, outer_diameter=1e-3, young_modulus=STEEL, density=7800.0)
    expected = natural_frequency(slender, mode=1, theory="Euler-Bernoulli")
    assert natural_frequency(slender, mode=1, theory=theory) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("whirl", WHIRLS)
def test_gyroscopic_splitting_of_a_spinning_shaft(whirl: Whirl) -> None:
    """Rayleigh: (1 + β) ω² ∓ 2Ωβ ω = ω₀² with β = (nπd/4L)²."""
    spin, sense = 900.0, 1.0 if whirl == "forward" else -1.0
    beta = (2 * math.pi * 0.12 / 4) ** 2
    euler = natural_frequency(SHAFT, mode=2, theory="Euler-Bernoulli")
    turning = sense * spin * beta
    expected = (turning + math.sqrt(turning**2 + (1 + beta) * euler**2)) / (1 + beta)
    assert natural_frequency(SHAFT, mode=2, theory="Rayleigh", spin=spin, whirl=whirl) == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("spin", [0.0, 800.0])
def test_finite_elements_agree_with_timoshenkos_closed_form(spin: float) -> None:
    """40 elements between bearings of 1e13 N/m, and a disc of next to nothing; backward and forward whirl of two modes."""
    document = one_disc_document(
        diameter=0.12, mass=1e-9, diametral_inertia=0.0, polar_inertia=0.0, kxx=1e13, kyy=1e13, cxx=1e-6, cyy=1e-6,
        element_length=0.025,
    )  # fmt: skip
    found = natural_frequencies(parse_machine(document), spin=spin)[:4]
    expected = [natural_frequency(SHAFT, mode=n, spin=spin, whirl=w) for n in (1, 2) for w in ("backward", "forward")]
    assert found == pytest.approx(expected, rel=1e-4)


def test_a_hollow_shaft_has_the_closed_form_of_its_own_section() -> None:
    tube = SimplySupportedShaft(span=1.0, outer_diameter=0.12, inner_diameter=0.06, young_modulus=STEEL, density=7800.0)
    radius_of_gyration = math.sqrt(0.12**2 + 0.06**2) / 4
    expected = math.pi**2 * radius_of_gyration * math.sqrt(STEEL / 7800.0)
    assert natural_frequency(tube, mode=1, theory="Euler-Bernoulli") == pytest.approx(expected, rel=1e-12)
    assert tube.mass == pytest.approx(SHAFT.mass * 0.75)


@pytest.mark.parametrize(("diameter", "disc_mass", "printed"), [(0.016, 0.66, 373.0), (0.012, 1.01, 169.0)])
def test_appendix_c_needs_the_diameters_the_other_way_round(diameter: float, disc_mass: float, printed: float) -> None:
    """Table C.1 [Hz], to half of its last digit and the last digit of the masses in Table 5.1."""
    shaft = SimplySupportedShaft(span=0.208, outer_diameter=diameter, young_modulus=STEEL, density=7740.0)
    frequency = disc_at_midspan_frequency(shaft, disc_mass=disc_mass)
    assert frequency / (2 * math.pi) == pytest.approx(printed, rel=0.005)
    hertz = 2 * math.pi * printed
    assert span_for(frequency=hertz, diameter=diameter, disc_mass=disc_mass, young_modulus=STEEL) == pytest.approx(
        0.208, rel=0.003
    )


def test_the_span_undoes_the_frequency() -> None:
    shaft = SimplySupportedShaft(span=0.4, outer_diameter=0.02, young_modulus=STEEL, density=7800.0)
    frequency = disc_at_midspan_frequency(shaft, disc_mass=2.0)
    assert span_for(frequency=frequency, diameter=0.02, disc_mass=2.0, young_modulus=STEEL) == pytest.approx(0.4, rel=1e-12)


def test_the_shafts_own_mass_counts_by_seventeen_thirtyfifths() -> None:
    """An upper bound, and near the finite-element model's first frequency where the disc is heavy."""
    shaft = SimplySupportedShaft(span=1.0, outer_diameter=0.03, young_modulus=STEEL, density=7800.0)
    document = one_disc_document(
        mass=5.0, diametral_inertia=0.0, polar_inertia=0.0, kxx=1e12, kyy=1e12, cxx=1e-6, cyy=1e-6, element_length=0.05
    )
    found = float(natural_frequencies(parse_machine(document))[0])
    bound = disc_at_midspan_frequency(shaft, disc_mass=5.0, massless=False)
    assert found <= bound == pytest.approx(found, rel=3e-3)
    assert disc_at_midspan_frequency(shaft, disc_mass=5.0) > 1.1 * bound
    moving = 5.0 + 17 / 35 * shaft.mass
    assert bound == pytest.approx(math.sqrt(shaft.midspan_stiffness / moving), rel=1e-12)


def test_the_share_of_seventeen_thirtyfifths_is_that_of_the_deflection_under_a_force() -> None:
    """∫ (3ξ - 4ξ³)² dξ over half the span, twice."""
    xi, weight = np.polynomial.legendre.leggauss(8)
    xi, weight = (xi + 1) / 4, weight / 4
    assert 2 * float(weight @ (3 * xi - 4 * xi**3) ** 2) == pytest.approx(17 / 35, rel=1e-12)


@pytest.mark.parametrize("name", ["span", "outer_diameter", "young_modulus", "density"])
def test_what_cannot_be_a_shaft_is_named(name: str) -> None:
    values = {"span": 1.0, "outer_diameter": 0.02, "young_modulus": STEEL, "density": 7800.0}
    with pytest.raises(ValueError, match=name):
        SimplySupportedShaft(**{**values, name: 0.0})


def test_other_impossible_input_is_named() -> None:
    with pytest.raises(ValueError, match="inner_diameter"):
        SimplySupportedShaft(span=1.0, outer_diameter=0.02, inner_diameter=0.02, young_modulus=STEEL, density=7800.0)
    with pytest.raises(ValueError, match="mode 0"):
        natural_frequency(SHAFT, mode=0)
    with pytest.raises(ValueError, match="spin"):
        natural_frequency(SHAFT, mode=1, spin=-1.0)
    with pytest.raises(ValueError, match="disc_mass"):
        disc_at_midspan_frequency(SHAFT, disc_mass=0.0)
