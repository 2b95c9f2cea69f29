"""Input that is legal but awkward: zeros and gaps under a noise model without floor, parts nearly in one place."""

from dataclasses import replace

import numpy as np
import pytest
from test_identification import CLEAN, SPEED, assert_at_the_bound, measured
from test_modes import jeffcott
from trains import chapter_3, chapter_3_document, noisy, one_disc_document

from estimator.condensation import condense
from estimator.identification import NotEnoughData, identify
from estimator.machine import DocumentError, parse_machine
from estimator.measurement import Measurement
from estimator.modes import critical_speeds


def test_missing_channel_with_a_noise_model_without_floor() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[3, 2] = np.nan
    assert_at_the_bound(identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor)))


def test_single_usable_zero_with_a_noise_model_without_floor() -> None:
    phasor = noisy(CLEAN, seed=0)
    phasor[5, 3] = 0.0
    identify(chapter_3(), Measurement.of(speed=SPEED, phasor=phasor))


def test_all_zero_with_a_noise_model_without_floor() -> None:
    with pytest.raises(NotEnoughData, match="every usable phasor is zero"):
        identify(chapter_3(), Measurement.of(speed=SPEED, phasor=np.zeros_like(CLEAN)))


def test_scatter_of_zero_with_a_noise_model_without_floor() -> None:
    measurement = measured(0)
    scatter = measurement.scatter.copy()
    scatter[0, 0] = 0.0
    identify(chapter_3(), replace(measurement, scatter=scatter))


def test_critical_speeds_far_below_the_highest() -> None:
    low = critical_speeds(chapter_3(), highest=440.0)
    assert critical_speeds(chapter_3(), highest=6000.0)[:8] == pytest.approx(low, rel=1e-6)


def test_jeffcott_far_below_the_highest() -> None:
    assert critical_speeds(jeffcott(), highest=6000.0)[:2] == pytest.approx([200.0, 200.0], rel=1e-2)


def test_only_the_wrong_field_of_a_lone_part_is_named() -> None:
    document = chapter_3_document()
    document["shafts"][0]["sections"][0]["length"] = -1
    with pytest.raises(DocumentError) as caught:
        parse_machine(document)
    assert [field for field, _ in caught.value.problems] == ["shafts[0].sections[0].length"]


def test_chain_of_near_stations() -> None:
    document = one_disc_document()
    document["probes"] = [{"id": f"P{i}", "shaft": "S", "station": 0.3 + i * 0.9e-9, "angle_deg": 0} for i in range(4)]
    condense(parse_machine(document), speed=np.array([10.0]), direction=np.array([1.0]))
