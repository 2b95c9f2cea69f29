"""Unbalance gained since a calibration, where trial weights told the factor on all gains only roughly."""

from dataclasses import dataclass

import numpy as np
import pytest

from estimator.arrays import Complexes, Floats
from estimator.calibration.unbalance_since import unbalance_since
from estimator.machine.calibration import Calibration
from estimator.machine.document import Machine, parse_machine
from tests.plant import document

OWN = 5e-3 * np.exp(0.7j)
"""Unbalance of the machine in its calibration [kg m], 500 times what it gains later."""
GAINED = 1e-5 * np.exp(-1.2j)
ROUGH, SHARP = 0.15, 1e-6
"""Standard errors of the factor on all gains, and of all else [-]."""


@dataclass(frozen=True)
class _Fit:
    """A later fit, as `unbalance_since` reads it."""

    coordinates: tuple[str, ...]
    point: Floats
    covariance: Floats


def _machine(rotation: str) -> Machine:
    said = document()
    probes = [one | {"gain_spread": 3.0} for one in said["probes"]]
    discs = said["discs"][:1]
    return parse_machine(said | {"rotation": rotation, "discs": discs, "probes": probes})


def _names(machine: Machine) -> tuple[str, ...]:
    names = [*(f"probe.{probe.id}.gain" for probe in machine.probes), f"disc.{machine.discs[0].id}.unbalance"]
    return tuple(f"{name}.{part}" for name in names for part in ("real", "imaginary"))


def _point(machine: Machine, factor: complex, unbalance: complex, *, rough: float = ROUGH) -> tuple[Floats, Floats]:
    """Coordinates and their covariance where all gains are one factor: readings, gain times unbalance, are known sharply."""
    count = len(machine.probes)

    def acting(vector: complex) -> complex:
        return vector if machine.direction > 0 else vector.conjugate()

    ways = [np.r_[np.full(count, factor * turn), acting(-acting(unbalance) * turn)] for turn in (1.0, 1.0j)]
    small = SHARP * np.r_[np.ones(2 * count), np.full(2, abs(unbalance))]
    covariance = rough**2 * sum(np.outer(_parts(way), _parts(way)) for way in ways) + np.diag(small**2)
    return _parts(np.r_[np.full(count, factor - 1.0), unbalance]), covariance


def _parts(values: Complexes) -> Floats:
    return np.stack([values.real, values.imag], axis=-1).reshape(-1)


@pytest.mark.parametrize("rotation", ["positive", "negative"])
@pytest.mark.parametrize("factor", [1.0 + 0.0j, 1.06 - 0.09j])
def test_a_factor_on_all_gains_takes_nothing_from_what_was_gained(rotation: str, factor: complex) -> None:
    machine = _machine(rotation)
    names, first = _names(machine), 0.8 * np.exp(0.4j)
    values, covariance = _point(machine, first, OWN)
    calibration = Calibration(
        parameters=names,
        values=tuple(values.tolist()),
        covariance=tuple(map(tuple, covariance.tolist())),
        unbalances=names[-2:],
    )
    calibrated = machine.model_copy(update={"calibration": calibration})
    seen = factor if machine.direction > 0 else factor.conjugate()
    found = unbalance_since(calibrated, _Fit(names, *_point(machine, first * factor, OWN / seen + GAINED)))
    assert found is not None
    assert found.value[0] == pytest.approx(GAINED, abs=1e-3 * abs(GAINED))
    assert found.standard_error(0) == pytest.approx(ROUGH * abs(GAINED), rel=0.1), "the factor is open for what was gained"


@pytest.mark.parametrize("rotation", ["positive", "negative"])
def test_a_factor_by_which_gains_have_drifted_takes_nothing_from_what_was_gained(rotation: str) -> None:
    """A calibration that knows its gains sharply and lets them drift: its unbalance stays where it was."""
    machine = _machine(rotation)
    names, sharp = _names(machine), 1e-5
    values, covariance = _point(machine, 1.0 + 0.0j, OWN, rough=sharp)
    calibration = Calibration(
        parameters=names,
        values=tuple(values.tolist()),
        covariance=tuple(map(tuple, covariance.tolist())),
        unbalances=names[-2:],
        gain_drift=0.05,
    )
    calibrated = machine.model_copy(update={"calibration": calibration})
    found = unbalance_since(calibrated, _Fit(names, *_point(machine, 1.04 + 0.03j, OWN + GAINED, rough=sharp)))
    assert found is not None
    assert found.value[0] == pytest.approx(GAINED, abs=0.02 * abs(GAINED))
    assert found.standard_error(0) < 0.02 * abs(GAINED)


def test_where_a_gain_is_held_there_is_no_factor() -> None:
    machine = _machine("positive")
    names = _names(machine)
    values, covariance = _point(machine, 1.0 + 0.0j, OWN)
    kept = slice(2, None)
    calibration = Calibration(
        parameters=names[kept],
        values=tuple(values[kept].tolist()),
        covariance=tuple(map(tuple, covariance[kept, kept].tolist())),
        unbalances=names[-2:],
    )
    calibrated = machine.model_copy(update={"calibration": calibration})
    found = unbalance_since(calibrated, _Fit(names[kept], values[kept], covariance[kept, kept]))
    assert found is not None
    assert abs(found.value[0]) < 1e-6 * abs(OWN)
