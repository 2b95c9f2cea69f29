"""Factors on makers' tables that are off as a whole, or by more than their documents allow."""

import re

import numpy as np
import pytest

from estimator.fit.identification import Identification
from estimator.fit.identify import identify
from estimator.machine.document import parse_machine
from estimator.phasors.measurement import Measurement
from tests.estimator.bearings.test_table import DIRECT, SPEED, drawn_factors, tabulated, truth_phasors
from tests.estimator.trains import noisy

SEEMS_OFF = re.compile(r"the table of bearing\.B\d seems off by (\S+) %, more than its scale_spread of (\S+) % says")

Factors = dict[str, dict[str, float]]


def found_by(factors: Factors, *, spread: float, noise: float, seed: int) -> Identification:
    """Identify Chapter 3 on tables whose true values are theirs times factors, with relative noise."""
    document = tabulated(spread) | {"noise": {"relative": noise, "floor": 1e-9}}
    phasor = noisy(truth_phasors(document, factors), seed=seed, relative=noise)
    return identify(parse_machine(document), Measurement.of(speed=SPEED, phasor=phasor, direction=1))


def whole(factor: float) -> Factors:
    return {f"B{number}": dict.fromkeys(DIRECT, factor) for number in range(1, 5)}


def held(found: Identification, factors: Factors) -> list[bool]:
    """Check which intervals of factors that are told hold the truth."""
    true = {f"bearing.{bearing}.{name}_scale": factor for bearing, each in factors.items() for name, factor in each.items()}
    told = [one for one in found.estimates if one.name in true]
    return [one.lower <= true[one.name] <= one.upper for one in told if one.lower is not None and one.upper is not None]


@pytest.mark.parametrize("factor", [0.7, 1.35])
def test_the_verdict_says_which_table_is_off_by_more_than_its_document_allows(factor: float) -> None:
    found = found_by(whole(factor), spread=0.15, noise=0.05, seed=1)
    assert found.accepted, found.verdict
    told = SEEMS_OFF.search(found.verdict)
    assert told is not None, found.verdict
    assert float(told[1]) == pytest.approx(100 * abs(np.log(factor)), rel=0.05)
    assert told[2] == "15"
    assert np.mean(held(found, whole(factor))) >= 0.86


def test_nothing_is_said_of_tables_that_are_off_by_what_their_document_allows() -> None:
    for seed in range(4):
        found = found_by(drawn_factors(0.15, seed), spread=0.15, noise=0.05, seed=seed)
        assert found.accepted, found.verdict
        assert "scale_spread" not in found.verdict


def test_intervals_hold_where_tables_are_off_as_a_whole_and_the_data_hardly_show_it() -> None:
    """Believed in one by one, sixteen factors would have a mean that is known four times as well as any of them."""
    inside = [one for seed in range(3) for one in held(found_by(whole(1.04), spread=0.02, noise=0.3, seed=seed), whole(1.04))]
    assert len(inside) > 40
    assert np.mean(inside) >= 0.9
