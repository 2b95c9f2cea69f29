"""Elimination by bands, for long trains, against that of the dense system: the same to what rounding leaves."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.rotor import elimination
from estimator.rotor.condensation import CondensedTrain, condense
from estimator.rotor.elimination import SingularCondensation
from estimator.rotor.response import Sensitivity, sensitivity
from tests.estimator.long_trains import TRAINS, plain
from tests.estimator.trains import Document

SPEED = np.linspace(40.0, 400.0, 7)
DIRECTION = np.where(np.arange(7) % 2 == 0, 1.0, -1.0)


def condensed(document: Document, monkeypatch: pytest.MonkeyPatch, *, banded: bool) -> CondensedTrain:
    monkeypatch.setattr(elimination, "FEWEST_BANDED", 0 if banded else 10**6)
    return condense(parse_machine(document), speed=SPEED, direction=DIRECTION)


def sensitive(train: CondensedTrain) -> Sensitivity:
    """Compute the sensitivity at scale factors other than 1, where there are any."""
    unknown = train.unknowns
    coefficients = np.array([one.expected for one in unknown.coefficients])
    excitations = np.array([one.nominal or 1e-4 + 2e-4j for one in unknown.excitations], dtype=complex)
    return sensitivity(train.scaled(1.0 + 0.01 * train.scale_spread), coefficients=coefficients, excitations=excitations)


@pytest.mark.parametrize("known", [True, False], ids=["E and density known", "identified"])
@pytest.mark.parametrize("name", TRAINS)
def test_bands_give_the_same_response_and_slopes(name: str, known: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    document = TRAINS[name]()
    for shaft in document["shafts"]:
        shaft["bow_spread"] = 1e-4
    for material in () if known else document["materials"].values():
        material.update(young_modulus_spread=0.02, density_spread=0.01)
    expected = sensitive(condensed(document, monkeypatch, banded=False))
    found = sensitive(condensed(document, monkeypatch, banded=True))
    assert (found.by_scale.size > 0) is not known
    for one in ("phasor", "by_coefficient", "by_excitation", "by_scale"):
        whole = getattr(expected, one)
        assert np.max(np.abs(getattr(found, one) - whole), initial=0.0) <= 1e-8 * np.max(np.abs(whole), initial=0.0)


def test_bands_keep_no_transfer(monkeypatch: pytest.MonkeyPatch) -> None:
    document = plain()
    document["materials"]["steel"].update(young_modulus_spread=0.02)
    train = condensed(document, monkeypatch, banded=True)
    assert isinstance(train.shafts, elimination.WhirlElimination)
    assert train.shafts.forward.transfer.size == train.shafts.forward.response.size == 0


def test_a_speed_that_cannot_be_condensed_at_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(elimination, "LARGEST_TRANSFER", 1e-12)
    with pytest.raises(SingularCondensation, match=f"speed {SPEED[0]:.6g} rad/s falls on a natural frequency"):
        condensed(plain(), monkeypatch, banded=True)
