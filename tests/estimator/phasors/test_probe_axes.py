"""x and y from probes at any angles."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from estimator.machine.document import Machine, parse_machine
from estimator.phasors.probe_axes import LARGEST_CONDITION, axis_phasors, probe_stations
from tests.estimator.trains import chapter_3_document, few_examples

finite = st.floats(-1.0, 1.0)


def with_probes(*angles: float, second: float | None = None) -> Machine:
    """The Chapter 3 train with probes at one station, and one more at another where an angle is given for it."""
    document = chapter_3_document()
    document["probes"] = [{"id": f"P{i}", "shaft": "S1", "station": 1.0, "angle_deg": a} for i, a in enumerate(angles)]
    if second is not None:
        document["probes"].append({"id": "Q", "shaft": "S2", "station": 1.0, "angle_deg": second})
    return parse_machine(document)


@few_examples
@given(st.floats(-180, 180), st.floats(15, 165), st.lists(st.floats(-180, 180), max_size=2), st.tuples(*[finite] * 4))
def test_any_angles_give_back_what_they_measure(
    first: float, between: float, others: list[float], parts: tuple[float, float, float, float]
) -> None:
    x, y = complex(parts[0], parts[1]), complex(parts[2], parts[3])
    angles = [first, first + between, *others]
    (place,) = probe_stations(with_probes(*angles))
    phasor = np.array([[x * math.cos(math.radians(a)) + y * math.sin(math.radians(a)) for a in angles]])
    found = axis_phasors(place, phasor=phasor, usable=np.ones(phasor.shape, dtype=bool))
    assert abs(found.x[0] - x) < 1e-9
    assert abs(found.y[0] - y) < 1e-9


@pytest.mark.parametrize("between", [20.0, 45.0, 60.0, 90.0, 120.0])
def test_condition_of_two_angles_in_closed_form(between: float) -> None:
    # DᵀD has the eigenvalues 1 ± |cos of the angle between|.
    (place,) = probe_stations(with_probes(30.0, 30.0 + between))
    cosine = abs(math.cos(math.radians(between)))
    assert place.condition == pytest.approx(math.sqrt((1 + cosine) / (1 - cosine)))
    assert place.sees_both_axes


def test_three_probes_are_fitted_by_least_squares_and_carry_on_with_two() -> None:
    (place,) = probe_stations(with_probes(0.0, 60.0, 120.0))
    rng = np.random.default_rng(1)
    phasor = rng.standard_normal((2, 3)) + 1j * rng.standard_normal((2, 3))
    usable = np.array([[True, True, True], [True, False, True]])
    found = axis_phasors(place, phasor=phasor, usable=usable)
    for sample in range(2):
        kept = usable[sample]
        expected, *_ = np.linalg.lstsq(place.directions[kept], phasor[sample, kept], rcond=None)
        assert np.allclose([found.x[sample], found.y[sample]], expected)
        assert np.allclose(found.inverse[sample] @ np.where(kept, phasor[sample], 0.0), expected)


@pytest.mark.parametrize("angles", [(10.0,), (10.0, 10.0), (10.0, 190.0), (10.0, 15.0)])
def test_probes_along_one_line_stay_channels(angles: tuple[float, ...]) -> None:
    (place,) = probe_stations(with_probes(*angles))
    assert not place.sees_both_axes
    assert place.condition > LARGEST_CONDITION
    found = axis_phasors(place, phasor=np.ones((1, len(angles)), complex), usable=np.ones((1, len(angles)), bool))
    assert not found.known[0]
    assert np.isnan(found.x[0])


def test_a_lost_probe_leaves_the_other_alone() -> None:
    (place,) = probe_stations(with_probes(0.0, 90.0))
    phasor, usable = np.array([[1.0, np.nan], [1.0, 2.0]], dtype=complex), np.array([[True, False], [True, True]])
    assert axis_phasors(place, phasor=phasor, usable=usable).known.tolist() == [False, True]


def test_probes_are_grouped_by_shaft_and_station() -> None:
    places = probe_stations(with_probes(0.0, 90.0, second=45.0))
    assert [(place.shaft, place.channels, place.columns) for place in places] == [
        ("S1", ("P0", "P1"), (0, 1)),
        ("S2", ("Q",), (2,)),
    ]
