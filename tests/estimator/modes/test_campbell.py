"""Campbell diagram: curves against the closed forms of a rigid rotor, whose modes cross each other, and laws of any train."""

import itertools

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.modes.campbell import Campbell, assurance, campbell, modal_assurance
from estimator.modes.critical_speed import critical_speeds
from estimator.modes.eigenmodes import Modes, eigenvalues
from estimator.rotor.assembly import assemble_rotor
from tests.estimator.rigid_rotor import bounce, conical, rigid_rotor
from tests.estimator.trains import chapter_3, chapter_3_document, mirrored

INERTIA = {"diametral": 0.04, "polar": 0.03}
"""The conical modes start above the bounce; the backward one falls through it."""
SPEED = np.linspace(0.0, 400.0, 21)


@pytest.fixture(scope="module")
def rigid() -> Campbell:
    return campbell(rigid_rotor(**INERTIA), speed=SPEED, highest_frequency=600.0)


@pytest.fixture(scope="module")
def train() -> Campbell:
    return campbell(chapter_3(), speed=np.linspace(10.0, 600.0, 30), highest_frequency=700.0)


def closed_form(forward: bool) -> np.ndarray:
    return np.array([conical(spin, **INERTIA, forward=forward) for spin in SPEED])


def test_curves_cross_without_being_exchanged(rigid: Campbell) -> None:
    expected = [closed_form(False), closed_form(True), np.full(SPEED.size, bounce()), np.full(SPEED.size, bounce())]
    assert expected[0][0] > bounce() > expected[0][-1], "the backward conical mode crosses the bounce"
    assert rigid.frequency.shape == (SPEED.size, 4)
    best = min(
        max(np.max(np.abs(rigid.frequency[:, i] / expected[j] - 1)) for i, j in enumerate(order))
        for order in itertools.permutations(range(4))
    )
    assert best < 1e-4


def test_whirl_of_the_conical_modes(rigid: Campbell) -> None:
    highest, lowest = np.argmax(rigid.frequency[-1]), np.argmin(rigid.frequency[-1])
    assert rigid.whirl[1:, highest] == pytest.approx(np.ones(SPEED.size - 1), abs=1e-6)
    assert rigid.whirl[1:, lowest] == pytest.approx(-np.ones(SPEED.size - 1), abs=1e-6)


def test_a_mirrored_rotor_has_the_same_diagram(train: Campbell) -> None:
    other = campbell(parse_machine(mirrored(chapter_3_document())), speed=train.speed, highest_frequency=700.0)
    assert other.eigenvalue == pytest.approx(train.eigenvalue, rel=1e-8)
    assert other.whirl == pytest.approx(train.whirl, abs=1e-6)


def test_every_mode_is_on_one_curve(train: Campbell) -> None:
    for speed, row in zip(train.speed, train.eigenvalue, strict=True):
        found = eigenvalues(chapter_3(), spin=speed)
        shown = row[row.imag <= 700.0]
        assert np.sort(shown.imag) == pytest.approx(found.imag[found.imag <= 700.0], rel=1e-9)


def test_neighbouring_points_of_a_curve_have_like_frequencies_and_damping(train: Campbell) -> None:
    fine = campbell(chapter_3(), speed=np.linspace(10.0, 600.0, 119), highest_frequency=700.0)
    steps = np.abs(np.diff(fine.eigenvalue, axis=0)) / np.abs(fine.eigenvalue[1:])
    assert steps.max() < 0.02
    # The coarse diagram follows the same modes from the first speed to the last.
    ends = {tuple(np.round(pair, 6)) for pair in fine.frequency[[0, -1]].T}
    assert {tuple(np.round(pair, 6)) for pair in train.frequency[[0, -1]].T} == ends


def test_damping_is_that_of_the_eigenvalues(train: Campbell) -> None:
    root = train.eigenvalue
    assert train.damping_ratio == pytest.approx(-root.real / np.hypot(root.real, root.imag))
    decay = np.exp(root.real * 2 * np.pi / root.imag)
    assert np.exp(-train.log_decrement) == pytest.approx(decay)
    assert np.all(train.damping_ratio > 0)


def test_critical_speeds_are_given_along(train: Campbell) -> None:
    assert [one.speed for one in train.critical_speeds] == pytest.approx(critical_speeds(chapter_3(), highest=600.0))


def test_order_of_the_bearings_in_the_document_changes_nothing(train: Campbell) -> None:
    document = chapter_3_document()
    document["bearings"] = document["bearings"][::-1]
    for number, bearing in enumerate(document["bearings"]):
        bearing["id"] = f"other-{number}"
    other = campbell(parse_machine(document), speed=train.speed, highest_frequency=700.0)
    assert other.eigenvalue == pytest.approx(train.eigenvalue, rel=1e-8)


def test_stiffness_and_damping_scale_frequencies(train: Campbell) -> None:
    """Everything elastic 4 times, damping and speed twice: every eigenvalue twice."""
    document = chapter_3_document()
    for material in document["materials"].values():
        material["young_modulus"] *= 4
    for part in (*document["bearings"], *document["couplings"]):
        for name in part:
            if name.startswith(("k", "c")) and isinstance(part[name], float):
                part[name] *= 4 if name.startswith("k") else 2
    other = campbell(parse_machine(document), speed=2 * train.speed, highest_frequency=1400.0)
    assert other.eigenvalue == pytest.approx(2 * train.eigenvalue, rel=1e-8)


def test_assurance_is_one_for_the_same_shape_and_zero_for_orthogonal_ones() -> None:
    mass = assemble_rotor(chapter_3()).mass
    values, vectors = np.linalg.eigh(mass)
    shapes = (vectors / np.sqrt(values))[:, :3].astype(complex)  # orthonormal in the mass
    assert assurance(shapes, shapes * 2j, mass) == pytest.approx(np.eye(3), abs=1e-9)


def test_coinciding_modes_are_alike_whatever_their_shapes() -> None:
    """Two shapes that span a plane, hardly apart from each other, are as good as two others of that plane."""
    shapes = np.eye(4, dtype=complex)

    def of(eigenvalue: list[complex], columns: np.ndarray) -> Modes:
        return Modes(np.array(eigenvalue), columns, columns)

    straight = of([1j, 1j, 2j], shapes[:, :3])
    skew = of([1j, 1j, 2j], np.stack([shapes[0], shapes[0] + 0.01 * shapes[1], shapes[2]], axis=1))
    apart = of([1j, 1.1j, 2j], shapes[:, :3])
    for before, after in ((straight, skew), (skew, straight), (skew, apart), (apart, skew)):
        found = modal_assurance(before, after, np.eye(4))
        assert found == pytest.approx(np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), abs=1e-9)
    assert modal_assurance(apart, apart, np.eye(4)) == pytest.approx(np.eye(3), abs=1e-12)


@pytest.mark.parametrize("speed", [[], [1.0, 1.0], [-1.0, 1.0], [0.0]])
def test_speeds_must_ascend(speed: list[float]) -> None:
    with pytest.raises(ValueError, match="ascending"):
        campbell(chapter_3(), speed=np.array(speed), highest_frequency=100.0)
