"""Orbits against points that run through known ellipses, and against the extreme radii found by looking around."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.rotor.whirl import orbit, whirl
from tests.estimator.trains import few_examples

part = st.floats(-1.0, 1.0).filter(lambda value: abs(value) > 1e-3)


def phasors(major: float, minor: float, inclination: float, delay: float) -> tuple[complex, complex]:
    """x and y of a point that turns from +x to +y (minor > 0) and is at the end of its major axis at ωt = delay."""
    z = complex(math.cos(inclination), math.sin(inclination))
    # x + jy = z (major cos τ + j minor sin τ), with τ = ωt - delay; cos τ has the phasor e^{-j delay}, sin τ -j of it.
    c = np.exp(-1j * delay)
    s = -1j * c
    return complex(z.real * major * c - z.imag * minor * s), complex(z.imag * major * c + z.real * minor * s)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(("major", "minor"), [(2.0, 1.0), (2.0, -0.5), (1.0, 0.0)])
@pytest.mark.parametrize("inclination", [-1.5, -0.4, 0.0, 0.7, 1.5])
@pytest.mark.parametrize("delay", [-1.0, 0.0, 2.0])
def test_an_ellipse_is_recognised(major: float, minor: float, inclination: float, delay: float, direction: int) -> None:
    x, y = phasors(major, minor, inclination, delay)
    found = orbit(np.array([x]), np.array([y]), direction=direction)
    assert found.semi_major[0] == pytest.approx(major)
    assert found.semi_minor[0] == pytest.approx(direction * minor, abs=1e-12)
    assert found.inclination[0] == pytest.approx(inclination)
    position = np.array([x, y]) * np.exp(1j * found.delay[0])
    expected = major * np.array([math.cos(inclination), math.sin(inclination)])
    assert position.real == pytest.approx(expected, abs=1e-12)


@few_examples
@given(part, part, part, part)
def test_semi_axes_are_the_extreme_radii(a: float, b: float, c: float, d: float) -> None:
    x, y = complex(a, b), complex(c, d)
    turn = np.exp(1j * np.linspace(0, math.pi, 20001))
    radius = np.hypot((x * turn).real, (y * turn).real)
    found = orbit(np.array([x]), np.array([y]), direction=1)
    assert found.semi_major[0] == pytest.approx(radius.max(), rel=1e-6)
    assert abs(found.semi_minor[0]) == pytest.approx(radius.min(), abs=1e-3)


def test_whirl_of_circles_and_lines() -> None:
    forward = np.array([1, -1j, 0.3j, 0.3])  # θ turned like the displacement: θx = 0.3j, θy = -j·θx
    shapes = np.array([forward, np.conj(forward), np.array([1, 1, 0, 0])], dtype=complex).T
    found = whirl(shapes, np.eye(4), direction=1)
    assert found == pytest.approx([1.0, -1.0, 0.0])
    assert whirl(shapes, np.eye(4), direction=-1) == pytest.approx([-1.0, 1.0, 0.0])
