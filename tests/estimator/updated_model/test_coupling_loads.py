"""Coupling forces: against Eq. 2.12 written out over displacements of the dense model, against the equilibrium of one shaft
alone, and bands against Monte Carlo."""

import math

import numpy as np
import pytest

from estimator.machine.document import Machine, parse_machine
from estimator.rotor.assembly import assemble_rotor
from estimator.rotor.parameters import dense, unknowns
from estimator.updated_model.coupling_loads import CouplingForce, coupling_forces
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import PhasorBand
from tests.estimator.models import draws, model_of
from tests.estimator.trains import Complexes, chapter_3, chapter_3_document, dense_elements, mirrored, truth

ROTOR = assemble_rotor(chapter_3())
SPEED = np.array([60.0, 121.0, 180.0, 290.0])
NAMES = ("force_x", "force_y", "moment_x", "moment_y")


def displacement(
    machine: Machine, stiffness: np.ndarray, damping: np.ndarray, unbalances: Complexes, speed: float
) -> Complexes:
    rotor = ROTOR
    direction = machine.direction
    force = np.zeros(rotor.size, dtype=complex)
    for disc, unbalance in zip(machine.discs, unbalances, strict=True):
        x = 4 * rotor.node(disc.shaft, disc.station)
        turning = unbalance if direction > 0 else unbalance.conjugate()
        force[x : x + 2] += speed**2 * turning * np.array([1, -1j * direction])
    whole = rotor.stiffness + stiffness - speed**2 * rotor.mass
    whole = whole + 1j * speed * (damping + direction * speed * rotor.gyroscopic)
    return np.asarray(np.linalg.solve(whole, force))


def by_the_thesis(machine: Machine, speed: float) -> Complexes:
    """(F_x, F_y, M_yz, M_xz) of Eq. 2.12 of the first coupling, nominal values."""
    rotor, coupling = ROTOR, machine.couplings[0]
    unbalances = [
        one.unbalance.magnitude * np.exp(1j * math.radians(one.unbalance.angle_deg)) for one in machine.discs if one.unbalance
    ]
    stiffness, damping = dense_elements(machine)
    q = displacement(machine, stiffness, damping, np.array(unbalances), speed)
    first, second = 4 * rotor.end_node(coupling.driver), 4 * rotor.first_node[coupling.driven]
    x, y, theta_x, theta_y = q[first : first + 4] - q[second : second + 4]
    k, c = ({name: getattr(coupling, f"{kind}{name}") for name in ("xx", "xy", "yx", "yy")} for kind in "kc")
    return np.array(
        [
            k["xx"] * x + k["xy"] * y + 1j * speed * (c["xx"] * x + c["xy"] * y),
            k["yx"] * x + k["yy"] * y + 1j * speed * (c["yx"] * x + c["yy"] * y),
            coupling.k_phix * theta_x,
            coupling.k_phiy * theta_y,
        ]
    )


def components(force: CouplingForce) -> list[PhasorBand]:
    return [getattr(force, name) for name in NAMES]


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_forces_are_those_of_the_thesis(turned: bool) -> None:
    machine = parse_machine(mirrored(chapter_3_document())) if turned else chapter_3()
    (found,) = coupling_forces(model_of(machine), speed=SPEED)
    values = np.array([one.value for one in components(found)]).T
    expected = np.array([by_the_thesis(machine, float(speed)) for speed in SPEED])
    assert values == pytest.approx(expected, rel=1e-8)
    assert (found.coupling, list(found.speed)) == ("C1", list(SPEED))


def test_forces_hold_the_driven_shaft_in_equilibrium() -> None:
    """The driven shaft alone, under its unbalance and the coupling's push, moves as it does in the train."""
    machine, model = chapter_3(), model_of(chapter_3())
    rotor = ROTOR
    stiffness, damping = dense_elements(machine)
    (found,) = coupling_forces(model, speed=SPEED)
    start = 4 * rotor.first_node["S2"]
    document = chapter_3_document()
    document["couplings"] = []
    alone_stiffness, alone_damping = dense_elements(parse_machine(document))
    for i, speed in enumerate(SPEED):
        q = displacement(machine, stiffness, damping, model.excitations, float(speed))
        alone = rotor.stiffness + alone_stiffness - speed**2 * rotor.mass
        alone = alone + 1j * speed * (alone_damping + speed * rotor.gyroscopic)
        needed = (alone @ q)[start:]
        for disc, unbalance in zip(machine.discs, model.excitations, strict=True):
            if disc.shaft == "S2":
                x = 4 * rotor.node("S2", disc.station) - start
                needed[x : x + 2] -= speed**2 * unbalance * np.array([1, -1j])
        push = np.array([one.value[i] for one in components(found)])
        assert needed[:4] == pytest.approx(push, rel=1e-6, abs=1e-6 * np.abs(push).max())


def test_bands_are_those_of_monte_carlo() -> None:
    """2000 draws tell a standard deviation within 1.6 % and a 97.5 % quantile within some 4 % of the half width."""
    machine, model = chapter_3(), model_of(chapter_3(), error=0.01)
    speed = np.array([90.0, 200.0])
    (found,) = coupling_forces(model, speed=speed)
    rotor = ROTOR
    unknown = unknowns(machine, rotor).coefficients
    left, right = (dense([getattr(one, side) for one in unknown], rotor.size) for side in ("left", "right"))
    viscous = np.array([one.quantity == "damping" for one in unknown])
    own = np.array([one.element == "coupling.C1" for one in unknown])
    second = 4 * rotor.first_node["S2"]
    drawn = []
    for coefficients, unbalances in draws(model, 2000):
        stiffness, damping = ((left[:, which] * coefficients[which]) @ right[:, which].T for which in (~viscous, viscous))
        push = [(left[:, which & own] * coefficients[which & own]) @ right[:, which & own].T for which in (~viscous, viscous)]
        row = []
        for omega in speed:
            q = displacement(machine, stiffness, damping, unbalances, float(omega))
            row.append(-((push[0] + 1j * omega * push[1]) @ q)[second : second + 4])
        drawn.append(row)
    cloud = np.array(drawn)  # (draws, S, 4)
    for number, one in enumerate(components(found)):
        spread = cloud[:, :, number]
        for part, index in (("real", 0), ("imag", 1)):
            expected = np.std(getattr(spread, part), axis=0)
            assert np.sqrt(one.covariance[:, index, index]) == pytest.approx(expected, rel=0.12)
        assert_quantiles(one, np.abs(spread))
    assert_quantiles(found.force, largest_in_a_turn(cloud[:, :, :2]))
    assert_quantiles(found.moment, largest_in_a_turn(cloud[:, :, 2:]))


def assert_quantiles(band: PhasorBand, drawn: np.ndarray) -> None:
    half = (band.upper - band.amplitude).max()
    assert np.quantile(drawn, 0.975, axis=0) == pytest.approx(band.upper, abs=0.15 * half)
    assert np.quantile(drawn, 0.025, axis=0) == pytest.approx(band.lower, abs=0.15 * half)


def largest_in_a_turn(load: Complexes) -> np.ndarray:
    """Return the longest of 720 vectors in a turn of loads (..., 2) over x and y."""
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 720))
    return np.asarray(np.max(np.linalg.norm((load[..., None] * turn).real, axis=-2), axis=-1))


@pytest.mark.parametrize("turned", [False, True], ids=["positive", "negative"])
def test_largest_load_is_the_longest_vector_of_a_turn(turned: bool) -> None:
    machine = parse_machine(mirrored(chapter_3_document())) if turned else chapter_3()
    (found,) = coupling_forces(model_of(machine), speed=SPEED)
    values = np.array([one.value for one in components(found)]).T
    assert found.force.amplitude == pytest.approx(largest_in_a_turn(values[:, :2]), rel=1e-4)
    assert found.moment.amplitude == pytest.approx(largest_in_a_turn(values[:, 2:]), rel=1e-4)


def test_sure_parameters_make_no_band() -> None:
    (found,) = coupling_forces(model_of(chapter_3(), error=0.0), speed=SPEED)
    for one in components(found):
        assert one.lower == pytest.approx(one.amplitude)
        assert one.upper == pytest.approx(one.amplitude)


def test_forces_grow_with_the_unbalances() -> None:
    model = model_of(chapter_3(), error=0.0)
    coefficients, unbalances = truth(chapter_3())
    twice = UpdatedModel.of(chapter_3(), coefficients=coefficients, unbalances=2j * unbalances, covariance=model.covariance)
    (one,), (other,) = coupling_forces(model, speed=SPEED), coupling_forces(twice, speed=SPEED)
    for a, b in zip(components(one), components(other), strict=True):
        assert b.value == pytest.approx(2j * a.value, rel=1e-10)


def test_forces_are_highest_at_critical_speeds() -> None:
    """Thesis Figure 3.24: very high at or near critical speeds. The train's are 122, 143, 162 and 175 rad/s below 200."""
    model = model_of(chapter_3(), error=0.0)
    (found,) = coupling_forces(model, speed=np.linspace(20.0, 200.0, 181))
    peak = found.speed[np.argmax(found.force_x.amplitude)]
    assert min(abs(peak - critical) for critical in (121.8, 142.8, 162.1, 175.5)) < 5.0


def test_a_train_without_coupling_has_no_forces() -> None:
    document = chapter_3_document()
    document["couplings"] = []
    assert coupling_forces(model_of(parse_machine(document)), speed=SPEED) == ()


@pytest.mark.parametrize("speed", [[0.0], [-1.0], [math.nan]])
def test_speeds_must_be_positive(speed: list[float]) -> None:
    with pytest.raises(ValueError, match="positive"):
        coupling_forces(model_of(chapter_3()), speed=np.array(speed))
