"""Rayleigh damping against its closed form and against the eigenvalues of a damped structure."""

import math

import numpy as np
import pytest

from estimator.rotor.rayleigh import RayleighCoefficients, rayleigh_damping


def test_the_two_given_ratios_come_back() -> None:
    damping = rayleigh_damping(lower_frequency=120.0, lower_ratio=0.01, upper_frequency=430.0, upper_ratio=0.025)
    assert damping.mass_coefficient / (2 * 120.0) + damping.stiffness_coefficient * 120.0 / 2 == pytest.approx(0.01, rel=1e-12)
    assert damping.mass_coefficient / (2 * 430.0) + damping.stiffness_coefficient * 430.0 / 2 == pytest.approx(
        0.025, rel=1e-12
    )
    assert damping.ratio(120.0) == pytest.approx(0.01, rel=1e-12)


def test_equal_ratios_have_the_textbook_coefficients() -> None:
    """α = 2ζω₁ω₂/(ω₁+ω₂), β = 2ζ/(ω₁+ω₂) (Clough and Penzien)."""
    damping = rayleigh_damping(lower_frequency=100.0, lower_ratio=0.02, upper_frequency=300.0, upper_ratio=0.02)
    assert damping.mass_coefficient == pytest.approx(2 * 0.02 * 100 * 300 / 400, rel=1e-12)
    assert damping.stiffness_coefficient == pytest.approx(2 * 0.02 / 400, rel=1e-12)


def test_the_ratio_is_smallest_between_the_two_frequencies() -> None:
    """(α/ω + βω)/2 has its minimum √(αβ) at √(α/β), for equal ratios the geometric mean of the frequencies."""
    damping = rayleigh_damping(lower_frequency=100.0, lower_ratio=0.02, upper_frequency=400.0, upper_ratio=0.02)
    least = math.sqrt(damping.mass_coefficient * damping.stiffness_coefficient)
    assert damping.ratio(200.0) == pytest.approx(least, rel=1e-12)
    assert least < 0.02


def test_modes_of_a_chain_are_damped_as_the_closed_form_says() -> None:
    """Eigenvalues of three masses on four springs: -Re λ/|λ| is ζ(|λ|) for every mode."""
    mass = np.diag([1.0, 2.0, 1.5])
    stiffness = 1e4 * np.array([[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
    damping = RayleighCoefficients(mass_coefficient=3.0, stiffness_coefficient=2e-4)
    matrix = damping.matrix(mass=mass, stiffness=stiffness)
    inverse = np.linalg.inv(mass)
    state = np.block([[np.zeros((3, 3)), np.eye(3)], [-inverse @ stiffness, -inverse @ matrix]])
    roots = np.linalg.eigvals(state)
    roots = roots[roots.imag > 0]
    assert roots.size == 3
    for root in roots:
        frequency = abs(root)
        assert -root.real / frequency == pytest.approx((3.0 / frequency + 2e-4 * frequency) / 2, rel=1e-10)


@pytest.mark.parametrize(
    ("lower", "lower_ratio", "upper", "upper_ratio", "said"),
    [
        (300.0, 0.01, 100.0, 0.01, "ascending"),
        (0.0, 0.01, 100.0, 0.01, "positive"),
        (100.0, 0.01, math.inf, 0.01, "finite"),
        (100.0, -0.01, 300.0, 0.01, "lower_ratio"),
        (100.0, 0.01, 300.0, math.nan, "upper_ratio"),
        (100.0, 0.01, 300.0, 0.04, "between 0.3333 and 3 times"),
        (100.0, 0.01, 300.0, 0.003, "between 0.3333 and 3 times"),
    ],
)
def test_impossible_requests_are_refused(
    lower: float, lower_ratio: float, upper: float, upper_ratio: float, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        rayleigh_damping(lower_frequency=lower, lower_ratio=lower_ratio, upper_frequency=upper, upper_ratio=upper_ratio)


def test_pure_mass_and_pure_stiffness_damping_are_allowed() -> None:
    by_stiffness = rayleigh_damping(lower_frequency=100.0, lower_ratio=0.01, upper_frequency=300.0, upper_ratio=0.03)
    by_mass = rayleigh_damping(lower_frequency=100.0, lower_ratio=0.03, upper_frequency=300.0, upper_ratio=0.01)
    assert by_stiffness.mass_coefficient == pytest.approx(0.0, abs=1e-9)
    assert by_stiffness.stiffness_coefficient == pytest.approx(2 * 0.01 / 100, rel=1e-12)
    assert by_mass.stiffness_coefficient == pytest.approx(0.0, abs=1e-12)
    assert by_mass.mass_coefficient == pytest.approx(2 * 0.03 * 100, rel=1e-12)
