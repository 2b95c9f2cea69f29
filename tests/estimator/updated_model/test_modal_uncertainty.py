"""Standard errors of natural frequencies and critical speeds, against differences and Monte Carlo."""

import numpy as np
import pytest
from msgspec.structs import replace

from estimator.modes.critical_speed import critical_speed_table, critical_speeds
from estimator.modes.eigenmodes import eigenvalues
from estimator.updated_model.modal_uncertainty import (
    critical_speed_errors,
    eigenvalue_slopes_by_coordinate,
    modes_at,
    natural_frequency_errors,
)
from estimator.updated_model.model import UpdatedModel
from estimator.updated_model.uncertainty import standard_errors
from tests.estimator.models import differences, draws, model_of, rich_model
from tests.estimator.trains import chapter_3

RICH = rich_model()


def lowest(model: UpdatedModel, speed: float) -> np.ndarray:
    found = eigenvalues(model.scaled_machine, coefficients=model.coefficients(speed), spin=model.machine.direction * speed)
    return found[:6]


@pytest.mark.parametrize("speed", [0.0, 180.0])
def test_slopes_by_every_kind_of_coordinate(speed: float) -> None:
    found = eigenvalue_slopes_by_coordinate(RICH, modes_at(RICH, speed=speed), speed=speed)[:6]
    expected = differences(RICH, lambda model: lowest(model, speed))
    size = np.sqrt(np.diag(RICH.covariance))
    assert found * size == pytest.approx(expected * size, abs=2e-4 * np.abs(expected * size).max())


def test_natural_frequencies_scatter_as_stated() -> None:
    """500 draws tell a standard deviation within 3 %; 13 % is four of those."""
    model = model_of(chapter_3(), error=0.01)
    drawn = [eigenvalues(chapter_3(), coefficients=coefficients)[:6].imag for coefficients, _ in draws(model, 500)]
    found = natural_frequency_errors(model, modes_at(model, speed=0.0), speed=0.0)[:6]
    assert np.std(drawn, axis=0) == pytest.approx(found, rel=0.13)


def test_errors_of_critical_speeds_are_those_of_small_changes() -> None:
    whole = model_of(chapter_3(), error=0.001)
    some = [0, 9, 21, 34]
    covariance = np.zeros_like(whole.covariance)
    covariance[np.ix_(some, some)] = whole.covariance[np.ix_(some, some)]
    model = replace(whole, covariance=covariance)
    table = critical_speed_table(chapter_3(), highest=300.0)
    slopes = []
    for place in some:
        size = np.sqrt(covariance[place, place])
        step = np.where(np.arange(whole.values.size) == place, size, 0.0)
        ahead, behind = (replace(model, values=model.values + sign * step).coefficients(0.0) for sign in (1, -1))
        moved = [critical_speeds(chapter_3(), highest=300.0, coefficients=at) for at in (ahead, behind)]
        slopes.append((moved[0] - moved[1]) / (2 * size))
    expected = standard_errors(np.array(slopes).T, covariance[np.ix_(some, some)])
    assert expected.size == 5
    assert critical_speed_errors(model, table) == pytest.approx(expected, rel=2e-3)


def test_errors_of_critical_speeds_where_coefficients_follow_the_speed() -> None:
    table = critical_speed_table(RICH.scaled_machine, highest=200.0, coefficients=RICH.coefficients)
    place = RICH.coordinates.index("bearing.B1.kxx@1500rpm")
    covariance = np.zeros_like(RICH.covariance)
    covariance[place, place] = 0.01**2
    found = critical_speed_errors(replace(RICH, covariance=covariance), table)
    moved = []
    for sign in (1, -1):
        step = np.zeros(RICH.values.size)
        step[place] = 0.01 * sign
        changed = replace(RICH, values=RICH.values + step)
        moved.append(critical_speeds(changed.scaled_machine, highest=200.0, coefficients=changed.coefficients))
    assert found == pytest.approx(np.abs(moved[0] - moved[1]) / 2, rel=0.02, abs=1e-5)


def test_sure_parameters_make_sure_frequencies() -> None:
    model = model_of(chapter_3(), error=0.0)
    assert np.all(natural_frequency_errors(model, modes_at(model, speed=100.0), speed=100.0) == 0.0)
