"""Names like a misspelt one: in capitals or not, and by their ends alone."""

import pytest

from estimator.close_matches import close_names, did_you_mean

KNOWN = ("bearing.B1.kxx", "bearing.B1.kxy", "coupling.C1.kxx", "disc.core-1.unbalance", "material.steel.young_modulus")


@pytest.mark.parametrize(
    ("name", "closest"),
    [
        ("bearing.B1.kx", "bearing.B1.kxy"),
        ("COUPLING.C1.KXX", "coupling.C1.kxx"),
        ("C1.kxx", "coupling.C1.kxx"),
        ("c1.kx", "coupling.C1.kxx"),
        ("unbalanse", "disc.core-1.unbalance"),
        ("steel.young", "material.steel.young_modulus"),
    ],
)
def test_a_misspelt_name_is_like_the_one_that_was_meant(name: str, closest: str) -> None:
    assert close_names(name, KNOWN)[0] == closest


def test_a_name_like_no_other_gets_no_clause() -> None:
    assert did_you_mean("quite different", KNOWN) == ""
    assert did_you_mean("kxx", ()) == ""


def test_three_names_at_most_are_named() -> None:
    assert did_you_mean("kxx", KNOWN) == "; did you mean 'bearing.B1.kxx' or 'coupling.C1.kxx' or 'bearing.B1.kxy'?"
