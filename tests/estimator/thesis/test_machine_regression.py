"""The thesis's Chapter 4 regression on a machine's own run: exact on data of its own reduced model, wrong on a plant's."""

import numpy as np
import pytest

from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from estimator.thesis.flexible_train import flexible_train
from estimator.thesis.machine_regression import NotMeasuredAtBearings, bearing_translations, regress
from estimator.thesis.reduced_model import reduced_response
from estimator.thesis.reduction import high_frequency_condensed
from tests.estimator.trains import chapter_3, chapter_3_document, dense_response, truth

SPEED = np.arange(40.0, 300.0, 4.0)


def own_data(machine_document: dict[str, object]) -> Measurement:
    """Phasors of the reduced model at the document's probes."""
    machine = parse_machine(machine_document)
    train = flexible_train(machine)
    coefficients, unbalances = truth(machine)
    model = high_frequency_condensed(train, speed=SPEED, direction=np.ones_like(SPEED))
    found = reduced_response(model, coefficients=coefficients, unbalances=unbalances)
    x, y = found[:, 0::2], found[:, 1::2]
    angle = np.deg2rad([probe.angle_deg for probe in machine.probes])
    place = np.repeat(np.arange(4), 2)
    return Measurement.of(speed=SPEED, phasor=x[:, place] * np.cos(angle) + y[:, place] * np.sin(angle))


@pytest.mark.parametrize("turn", [0, 45])
def test_data_of_its_own_model_give_the_truth(turn: int) -> None:
    document = chapter_3_document()
    for probe in document["probes"]:
        probe["angle_deg"] += turn
    found = regress(parse_machine(document), own_data(document))
    coefficients, _ = truth(chapter_3())
    assert found.solution.values[:42] == pytest.approx(coefficients, rel=1e-4)
    assert found.names[0] == "bearing.B1.kxx"
    assert found.units[-1] == "kg m"
    assert not found.impossible


def test_data_of_the_machine_do_not() -> None:
    found = regress(chapter_3(), Measurement.of(speed=SPEED, phasor=dense_response(chapter_3(), SPEED, direction=1)))
    coefficients, _ = truth(chapter_3())
    assert np.median(np.abs(found.solution.values[:42] / coefficients - 1)) > 1.0
    assert found.reduced_chi_square > 100.0
    assert "bearing.B1.kxx" in found.impossible


def test_regularisation_draws_towards_the_nominal_values() -> None:
    measurement = Measurement.of(speed=SPEED, phasor=dense_response(chapter_3(), SPEED, direction=1))
    found = regress(chapter_3(), measurement, tikhonov="L-curve")
    assert found.solution.parameter > 0.0


def test_bearings_without_two_probes_are_named() -> None:
    document = chapter_3_document()
    document["probes"] = document["probes"][:-1]
    document["probes"][1]["angle_deg"] = 180
    machine = parse_machine(document)
    with pytest.raises(NotMeasuredAtBearings, match="missing at B1, B4"):
        bearing_translations(machine, Measurement.of(speed=SPEED, phasor=np.ones((SPEED.size, 7), dtype=complex)))
