"""The Timoshenko shaft element.

References: the element's matrices as energies of its static deflection shapes, integrated by Gauss quadrature in this file
(relative 1e-12); the cantilever's tip deflection FL³/3EI + FL/κGA (1e-9, exact in the element); the frequencies
(nπ/L)² √(EI/ρA) of a slender simply supported Euler-Bernoulli beam (2e-4 with 40 elements, of which 1.2e-4 is the shear and
rotary inertia that the closed form leaves out) and those of Timoshenko's own closed form, approached with the square of the
element length (1e-3 with 60 elements, 1e-5 extrapolated); Cowper's shear coefficient at its limits.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.linalg
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from estimator.machine.document import parse_machine
from estimator.modes.eigenmodes import natural_frequencies
from estimator.rotor.assembly import PlaneMatrices, across_planes, both_planes, plane_columns
from estimator.rotor.shaft_element import plane_element, shear_coefficient
from tests.estimator.trains import few_examples, one_disc_document

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Tube:
    """A uniform piece of shaft and its section properties by the textbook."""

    length: float
    outer: float
    inner: float
    young: float
    density: float
    poisson: float

    @property
    def area(self) -> float:
        return math.pi * (self.outer**2 - self.inner**2) / 4

    @property
    def second_moment(self) -> float:
        return math.pi * (self.outer**4 - self.inner**4) / 64

    @property
    def bending(self) -> float:
        return self.young * self.second_moment

    @property
    def shear(self) -> float:
        kappa = shear_coefficient(poisson_ratio=self.poisson, diameter_ratio=self.inner / self.outer)
        return kappa * self.area * self.young / (2 * (1 + self.poisson))

    def matrices(self, elements: int = 1) -> PlaneMatrices:
        element = plane_element(
            length=self.length / elements,
            outer_diameter=self.outer,
            inner_diameter=self.inner,
            young_modulus=self.young,
            density=self.density,
            poisson_ratio=self.poisson,
        )
        return PlaneMatrices(
            mass=both_planes(element.translation + element.rotation),
            gyroscopic=across_planes(2 * element.rotation),
            stiffness=both_planes(element.stiffness),
        )


tubes = st.builds(
    lambda length, slenderness, ratio, young, density, poisson: Tube(
        length, length * slenderness, length * slenderness * ratio, young, density, poisson
    ),
    st.floats(0.01, 3.0),
    st.floats(0.01, 2.0),
    st.floats(0.0, 0.9),
    st.floats(5e10, 4e11),
    st.floats(1000.0, 9000.0),
    st.floats(0.0, 0.45),
)


def by_quadrature(tube: Tube) -> PlaneMatrices:
    """The same matrices as energies of the deflection shapes v = cubic, slope = v' + (EI/κGA) v''' of an unloaded beam."""
    ratio, length = tube.bending / tube.shear, tube.length

    def shapes(z: float) -> tuple[Floats, Floats, Floats]:
        powers = np.array([1.0, z, z**2, z**3])
        first = np.array([0.0, 1.0, 2 * z, 3 * z**2])
        slope = first + ratio * np.array([0.0, 0.0, 0.0, 6.0])
        curvature = np.array([0.0, 0.0, 2.0, 6 * z])
        return powers, slope, curvature

    ends = np.array([shapes(0.0)[0], shapes(0.0)[1], shapes(length)[0], shapes(length)[1]])
    to_polynomial = np.linalg.inv(ends)
    # Rows: what an element's 8 degrees of freedom are in each plane's (v, slope, v, slope); the y-z slope is -θx.
    x_plane, y_plane = np.zeros((4, 8)), np.zeros((4, 8))
    x_plane[[0, 1, 2, 3], [0, 3, 4, 7]] = 1.0
    y_plane[[0, 1, 2, 3], [1, 2, 5, 6]] = (1.0, -1.0, 1.0, -1.0)
    mass, gyroscopic, stiffness = np.zeros((8, 8)), np.zeros((8, 8)), np.zeros((8, 8))
    for node, weight in zip(*np.polynomial.legendre.leggauss(6), strict=True):
        part = weight * length / 2
        v, slope, curvature = (row @ to_polynomial for row in shapes((node + 1) * length / 2))
        gradient = np.array([0.0, 1.0, (node + 1) * length, 3 * ((node + 1) * length / 2) ** 2]) @ to_polynomial
        for plane in (x_plane, y_plane):
            mass += part * tube.density * tube.area * np.outer(v @ plane, v @ plane)
            mass += part * tube.density * tube.second_moment * np.outer(slope @ plane, slope @ plane)
            stiffness += part * tube.bending * np.outer(curvature @ plane, curvature @ plane)
            stiffness += part * tube.shear * np.outer((gradient - slope) @ plane, (gradient - slope) @ plane)
        # A slice with polar inertia I needs the moments (I Ω dθy/dt, -I Ω dθx/dt) to turn its axis.
        theta_x, theta_y = -slope @ y_plane, slope @ x_plane
        polar = part * tube.density * 2 * tube.second_moment
        gyroscopic += polar * (np.outer(theta_x, theta_y) - np.outer(theta_y, theta_x))
    return PlaneMatrices(mass, gyroscopic, stiffness)


@few_examples
@given(tubes)
def test_matrices_are_the_energies_of_the_static_shapes(tube: Tube) -> None:
    found, expected = tube.matrices(), by_quadrature(tube)
    scale = np.array([1.0, 1.0, tube.length, tube.length] * 2)
    for name in ("mass", "gyroscopic", "stiffness"):
        # In units of length on every rotation, so that all entries of a matrix are of one kind.
        one, other = (getattr(matrices, name) / np.outer(scale, scale) for matrices in (found, expected))
        assert np.abs(one - other).max() < 1e-10 * np.abs(other).max(), name


@few_examples
@given(tubes)
def test_mass_and_stiffness_are_symmetric_and_gyroscopic_is_skew(tube: Tube) -> None:
    found = tube.matrices()
    assert np.abs(found.mass - found.mass.T).max() < 1e-15 * np.abs(found.mass).max()
    assert np.abs(found.stiffness - found.stiffness.T).max() < 1e-15 * np.abs(found.stiffness).max()
    assert np.abs(found.gyroscopic + found.gyroscopic.T).max() < 1e-15 * np.abs(found.gyroscopic).max()
    assert np.linalg.eigvalsh(found.mass).min() > 0


def rigid_motions(length: float) -> dict[str, Floats]:
    """Displacements of both nodes: along x, along y, about x (y = -z θx) and about y (x = z θy) through the first node."""
    return {
        "x": np.array([1.0, 0, 0, 0, 1, 0, 0, 0]),
        "y": np.array([0.0, 1, 0, 0, 0, 1, 0, 0]),
        "about x": np.array([0.0, 0, 1, 0, 0, -length, 1, 0]),
        "about y": np.array([0.0, 0, 0, 1, length, 0, 0, 1]),
    }


@few_examples
@given(tubes)
def test_rigid_body_motion_strains_nothing(tube: Tube) -> None:
    stiffness = tube.matrices().stiffness
    for name, motion in rigid_motions(tube.length).items():
        assert np.abs(stiffness @ motion).max() < 1e-13 * np.abs(stiffness).max() * max(1.0, tube.length), name
    assert np.linalg.matrix_rank(stiffness, tol=1e-10 * np.linalg.norm(stiffness, 2)) == 4


@few_examples
@given(tubes)
def test_rigid_body_motion_has_the_mass_and_the_inertias_of_the_tube(tube: Tube) -> None:
    found, motion = tube.matrices(), rigid_motions(tube.length)
    mass = tube.density * tube.area * tube.length
    for axis in ("x", "y"):
        assert motion[axis] @ found.mass @ motion[axis] == pytest.approx(mass, rel=1e-12)
    about_end = mass * tube.length**2 / 3 + tube.density * tube.second_moment * tube.length
    for axis in ("about x", "about y"):
        assert motion[axis] @ found.mass @ motion[axis] == pytest.approx(about_end, rel=1e-12)
    polar = 2 * tube.density * tube.second_moment * tube.length
    assert motion["about x"] @ found.gyroscopic @ motion["about y"] == pytest.approx(polar, rel=1e-12)


@pytest.mark.parametrize("elements", [1, 2, 7])
@pytest.mark.parametrize(
    ("plane", "sign"), [((0, 3), 1.0), ((1, 2), -1.0)], ids=["force along x turns about +y", "force along y turns about -x"]
)
@few_examples
@given(tube=tubes)
def test_cantilever_bends_and_shears(elements: int, plane: tuple[int, int], sign: float, tube: Tube) -> None:
    size = 4 * (elements + 1)
    stiffness = np.zeros((size, size))
    for i in range(elements):
        stiffness[4 * i : 4 * i + 8, 4 * i : 4 * i + 8] += tube.matrices(elements).stiffness
    force = np.zeros(size)
    force[size - 4 + plane[0]] = 1.0
    deflection = np.linalg.solve(stiffness[4:, 4:], force[4:])[-4:]
    assert deflection[plane[0]] == pytest.approx(tube.length**3 / (3 * tube.bending) + tube.length / tube.shear, rel=1e-9)
    assert deflection[plane[1]] == pytest.approx(sign * tube.length**2 / (2 * tube.bending), rel=1e-9)


def simply_supported(tube: Tube, elements: int) -> Floats:
    """Natural frequencies [rad/s] in one plane, by constraining both ends' x."""
    size = 4 * (elements + 1)
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    one = tube.matrices(elements)
    for i in range(elements):
        block = slice(4 * i, 4 * i + 8)
        mass[block, block] += one.mass
        stiffness[block, block] += one.stiffness
    free = [dof for dof in range(size) if dof % 4 in (0, 3) and dof not in (0, size - 4)]
    squares = scipy.linalg.eigh(stiffness[np.ix_(free, free)], mass[np.ix_(free, free)], eigvals_only=True)
    return np.sqrt(np.asarray(squares))


def timoshenko(tube: Tube, n: int) -> float:
    """Lower root of Timoshenko's frequency equation for mode n of a simply supported beam [rad/s]."""
    wave = (n * math.pi / tube.length) ** 2
    a = tube.density * tube.second_moment * tube.density * tube.area / tube.shear
    b = tube.density * tube.area + wave * (
        tube.density * tube.second_moment + tube.bending * tube.density * tube.area / tube.shear
    )
    c = tube.bending * wave**2
    return math.sqrt(2 * c / (b + math.sqrt(b**2 - 4 * a * c)))


def test_slender_beam_has_the_frequencies_of_euler_and_bernoulli() -> None:
    tube = Tube(length=2.0, outer=0.005, inner=0.0, young=2.1e11, density=7800.0, poisson=0.3)
    found = simply_supported(tube, 40)[:4]
    scale = math.sqrt(tube.bending / (tube.density * tube.area))
    expected = np.array([(n * math.pi / tube.length) ** 2 * scale for n in range(1, 5)])
    assert found == pytest.approx(expected, rel=2e-4)
    coarse = np.abs(simply_supported(tube, 5)[:4] / expected - 1)
    assert np.all(coarse[1:] > np.abs(found / expected - 1)[1:]), "a finer mesh comes nearer"


@pytest.mark.parametrize("inner", [0.0, 0.15])
def test_stout_beam_has_the_frequencies_of_timoshenko(inner: float) -> None:
    tube = Tube(length=1.0, outer=0.2, inner=inner, young=2.1e11, density=7800.0, poisson=0.3)
    expected = np.array([timoshenko(tube, n) for n in (1, 2, 3)])
    coarse, fine = (simply_supported(tube, elements)[:3] for elements in (30, 60))
    assert fine == pytest.approx(expected, rel=1e-3)
    assert (4 * fine - coarse) / 3 == pytest.approx(expected, rel=1e-5)
    euler = np.array([(n * math.pi) ** 2 for n in (1, 2, 3)]) * math.sqrt(tube.bending / (tube.density * tube.area))
    assert np.all(expected < 0.96 * euler), "shear and rotary inertia matter here"


def test_machine_on_very_stiff_bearings_is_a_simply_supported_beam() -> None:
    document = one_disc_document(
        length=2.0, diameter=0.01, mass=1e-9, diametral_inertia=0.0, polar_inertia=0.0, kxx=1e9, kyy=1e9, cxx=1e-6, cyy=1e-6
    )
    document["element_length"] = 0.1
    found = natural_frequencies(parse_machine(document))[:6]
    scale = math.sqrt(2.1e11 * math.pi / 64 * 0.01**4 / (7800 * math.pi / 4 * 0.01**2))
    expected = np.repeat([(n * math.pi / 2.0) ** 2 * scale for n in (1, 2, 3)], 2)
    assert found == pytest.approx(expected, rel=5e-4)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_shear_coefficient_of_a_solid_shaft(nu: float) -> None:
    found = shear_coefficient(poisson_ratio=nu, diameter_ratio=0.0)
    assert found == pytest.approx(6 * (1 + nu) / (7 + 6 * nu), rel=1e-15)


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
def test_shear_coefficient_of_a_thin_tube(nu: float) -> None:
    found = shear_coefficient(poisson_ratio=nu, diameter_ratio=1.0 - 1e-9)
    assert found == pytest.approx(2 * (1 + nu) / (4 + 3 * nu), rel=1e-8)


def test_shear_coefficient_falls_as_the_bore_grows() -> None:
    found = [shear_coefficient(poisson_ratio=0.3, diameter_ratio=ratio) for ratio in np.linspace(0, 0.99, 20)]
    assert np.all(np.diff(found) < 0)


def test_a_plane_becomes_whole_matrices_by_the_maps_of_its_columns() -> None:
    plane = np.random.default_rng(7).normal(size=(6, 6))
    x_plane, y_plane = plane_columns(12)
    assert np.array_equal(both_planes(plane), x_plane @ plane @ x_plane.T + y_plane @ plane @ y_plane.T)
    assert np.array_equal(across_planes(plane), x_plane @ plane @ y_plane.T - y_plane @ plane @ x_plane.T)
