"""Two causes at once on a machine on oil films: what happens to the plant, what counts as named, and as called otherwise."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.alignment.cause_pairs import both_named, called_otherwise
from benchmarks.alignment.film_fleet import FleetRecord, OpenedAlert, record_name, record_of
from benchmarks.alignment.film_histories import FilmHistory
from tests.film_plant.misalignment import true_alignment

ONSET = 9
HISTORY = FilmHistory(1000, "flexible", "beyond", ONSET, "wear")
SUNK, WORN = ("misalignment", "coupling.C1", "danger"), ("wear", "bearing.B1", "alert")


def record(*standing: tuple[str, str, str], opened: tuple[OpenedAlert, ...] = ()) -> FleetRecord:
    weeks = ((),) * ONSET + (standing,)
    return FleetRecord(
        seed=HISTORY.seed,
        kind=HISTORY.kind,
        happening=HISTORY.happening,
        onset=ONSET,
        weeks=len(weeks),
        baseline=5,
        refused=(),
        missed=(),
        opened=opened,
        standing=weeks,
        offsets=(),
        told_um=None,
        true_um=0.0,
        named=HISTORY.named,
        processor_s=0.0,
    )


def test_both_things_happen_to_the_plant_in_one_week() -> None:
    before, after = (HISTORY.plant_in(week) for week in (ONSET - 1, ONSET))
    grown = [b.clearance / a.clearance for a, b in zip(before.train.bearings, after.train.bearings, strict=True)]
    assert grown == pytest.approx([1.15, 1.0, 1.0, 1.0])
    offsets = [true_alignment(one)["coupling.C1.offset_vertical"].real for one in (before, after)]
    assert np.diff(offsets)[0] == pytest.approx(-2.0 * HISTORY.allowed.offset, abs=2e-6)  # and a week of the season
    assert record_name(HISTORY, weeks=12) != record_name(replace(HISTORY, beside="unbalance"), weeks=12)


def test_colder_oil_beside_another_cause_is_ten_kelvin_colder() -> None:
    oil = replace(HISTORY, beside="oil")
    assert oil.warmer(ONSET) == pytest.approx(HISTORY.warmer(ONSET) - 10.0)
    assert oil.warmer(ONSET - 1) == HISTORY.warmer(ONSET - 1)


def test_both_must_be_named_and_what_a_misalignment_brings_is_no_other_name() -> None:
    assert both_named(HISTORY, record(SUNK, WORN))
    assert not both_named(HISTORY, record(SUNK))
    opened = [OpenedAlert(ONSET + 1, *one, None) for one in (SUNK, WORN, ("light_load", "bearing.B2", "alert"))]
    assert list(called_otherwise(HISTORY, record(opened=tuple(opened)))) == []
    oil = OpenedAlert(ONSET + 1, "oil", "machine", "alert", None)
    assert list(called_otherwise(HISTORY, record(opened=(oil,)))) == [("oil", "machine")]
    assert list(called_otherwise(replace(HISTORY, beside="oil"), record(opened=(oil,)))) == []


@pytest.mark.long
@pytest.mark.parametrize("seed", [1, 1013])
def test_a_misaligned_turbine_generator_is_named_beside_a_softer_pedestal(seed: int) -> None:
    history = FilmHistory(seed, "flexible", "beyond", ONSET, "pedestal")
    found = record_of(history, weeks=ONSET + 3)
    assert both_named(history, found)
    assert list(called_otherwise(history, found)) == []
