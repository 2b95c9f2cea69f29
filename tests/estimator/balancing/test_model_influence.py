"""Influence coefficients of a model as the channels measure them."""

import numpy as np
import pytest

from estimator.balancing.model_influence import measured_model_influence
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement, joined
from estimator.updated_model.model import updated_model
from tests.estimator.trains import chapter_3_document, dense_response, noisy

SPEED = np.linspace(300.0, 40.0, 60)
GAIN = 1.25 * np.exp(0.2j)


def test_a_channel_with_a_gain_shows_the_models_influence_through_it() -> None:
    """The first channel measures a quarter too much; the trials see that, and the model is to see the same."""
    said = chapter_3_document()
    for probe in said["probes"]:
        probe["gain_spread"] = 0.2 if probe["id"] == said["probes"][0]["id"] else 0.0
    machine = parse_machine(said)
    heavier = chapter_3_document()
    added = 5e-3
    own = heavier["discs"][0]["unbalance"]
    total = own["magnitude"] * np.exp(1j * np.radians(own["angle_deg"])) + added
    heavier["discs"][0]["unbalance"] = {"magnitude": float(abs(total)), "angle_deg": float(np.degrees(np.angle(total)))}
    bare, loaded = (dense_response(one, SPEED, direction=1) for one in (machine, parse_machine(heavier)))
    gains = np.ones(len(machine.channels), dtype=complex)
    gains[0] = GAIN
    runs = [
        Measurement.of(speed=SPEED, phasor=noisy(gains * one, seed=seed, relative=1e-3))
        for seed, one in enumerate((bare, loaded))
    ]
    weights = np.zeros(len(machine.discs), dtype=complex)
    weights[0] = added
    whole = joined([runs[0].with_trial_weight(np.zeros_like(weights)), runs[1].with_trial_weight(weights)])
    found = identify(machine, whole)
    influence = measured_model_influence(updated_model(machine, found), machine, found.coordinates, found.point)
    shown = influence((machine.discs[0].id,), SPEED)[:, :, 0]
    expected = gains * (loaded - bare) / added
    assert shown[:, 0] == pytest.approx(expected[:, 0], rel=0.03)
    assert shown[:, 1:] == pytest.approx(expected[:, 1:], rel=0.03, abs=0.03 * float(np.max(np.abs(expected))))
