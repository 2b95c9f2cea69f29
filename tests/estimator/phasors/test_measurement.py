"""Measurements: shapes are checked, unusable values marked, and the error model is sqrt((r|X|)² + floor²) or the scatter."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.rules import Noise
from estimator.phasors.measurement import Measurement, joined
from estimator.phasors.noise import error_size
from tests.estimator.trains import few_examples

SPEED = np.array([10.0, 20.0, 30.0])
PHASOR = np.array([[1e-6 + 1e-6j, 2e-6], [3e-6j, np.nan], [complex(np.nan, np.inf), 5e-6]])


def parts(**changed: np.ndarray) -> dict[str, Any]:
    """The fields of a good measurement, some of them changed."""
    return {
        "speed": SPEED,
        "direction": np.ones(3),
        "phasor": PHASOR,
        "usable": np.isfinite(PHASOR),
        "scatter": np.full((3, 2), np.nan),
    } | changed


def test_finite_phasors_are_usable() -> None:
    found = Measurement.of(speed=SPEED, phasor=PHASOR, direction=-1)
    assert np.array_equal(found.usable, [[True, True], [True, False], [False, True]])
    assert np.array_equal(found.direction, [-1.0, -1.0, -1.0])
    assert np.all(np.isnan(found.scatter))
    assert found.phasor.dtype == complex


def test_lists_are_taken() -> None:
    found = Measurement.of(speed=[1, 2], phasor=[[1.0], [2.0]])  # type: ignore[arg-type]
    assert found.speed.dtype == float
    assert found.phasor.shape == (2, 1)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("speed", np.ones(2)),
        ("speed", np.ones((3, 1))),
        ("direction", np.ones(4)),
        ("usable", np.ones((3, 1), dtype=bool)),
        ("usable", np.ones((2, 3), dtype=bool)),
        ("scatter", np.ones(3)),
        ("scatter", np.ones((3, 3))),
    ],
)
def test_wrong_shape_is_named(name: str, value: np.ndarray) -> None:
    with pytest.raises(ValueError, match=f"{name} has shape .* should have"):
        Measurement(**parts(**{name: value}))


@pytest.mark.parametrize("value", [np.nan, complex(1.0, np.nan), np.inf])
def test_usable_phasor_must_be_finite(value: complex) -> None:
    phasor = np.ones((3, 2), dtype=complex)
    phasor[1, 1] = value
    with pytest.raises(ValueError, match="not finite"):
        Measurement(**parts(phasor=phasor, usable=np.ones((3, 2), dtype=bool)))
    usable = np.ones((3, 2), dtype=bool)
    usable[1, 1] = False
    assert Measurement(**parts(phasor=phasor, usable=usable)).usable.sum() == 5


def test_picked_samples() -> None:
    found = Measurement(**parts(scatter=np.arange(6.0).reshape(3, 2))).pick(np.array([True, False, True]))
    assert np.array_equal(found.speed, [10.0, 30.0])
    assert np.array_equal(found.scatter, [[0.0, 1.0], [4.0, 5.0]])
    assert np.array_equal(found.usable, [[True, True], [False, True]])
    assert found.direction.shape == (2,)


def test_joined_keeps_order_and_senses() -> None:
    one = Measurement.of(speed=SPEED, phasor=PHASOR)
    other = Measurement.of(speed=SPEED + 100, phasor=PHASOR, direction=-1)
    found = joined([one, other])
    assert np.array_equal(found.speed, [10, 20, 30, 110, 120, 130])
    assert np.array_equal(found.direction, [1, 1, 1, -1, -1, -1])
    assert np.array_equal(found.usable, np.vstack([one.usable, other.usable]))
    assert np.array_equal(found.phasor, np.vstack([PHASOR, PHASOR]), equal_nan=True)
    assert np.array_equal(joined([one]).speed, SPEED)


def test_nothing_to_join() -> None:
    with pytest.raises(ValueError, match="no measurement to join"):
        joined([])


def test_different_channels_do_not_join() -> None:
    one = Measurement.of(speed=SPEED, phasor=PHASOR)
    with pytest.raises(ValueError, match="dimension"):
        joined([one, Measurement.of(speed=SPEED, phasor=PHASOR[:, :1])])


def test_error_is_relative_at_large_amplitudes_and_the_floor_at_small_ones() -> None:
    noise = Noise(relative=0.03, floor=4e-8)
    found = error_size(noise, np.array([0.0, 1e-6, 1.0]), np.full(3, np.nan))
    assert found == pytest.approx([4e-8, 5e-8, 0.03], rel=1e-12)


@few_examples
@given(st.floats(0.0, 1e-2), st.floats(1e-9, 1e-3), st.floats(1e-4, 0.5), st.floats(0.0, 1e-6))
def test_scatter_of_the_source_counts_before_the_model(
    amplitude: float, scatter: float, relative: float, floor: float
) -> None:
    noise = Noise(relative=relative, floor=floor)
    found = error_size(noise, np.full(2, amplitude), np.array([scatter, np.nan]))
    assert found[0] == max(scatter, floor)
    assert found[1] == pytest.approx(np.hypot(relative * amplitude, floor), rel=1e-12)
