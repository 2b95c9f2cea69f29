"""Version of the balance of loads on films: where it matters, by the names of a fit's coordinates."""

import pytest

from estimator.machine.document import parse_machine
from estimator.machine.film_parameter_names import LOAD_BALANCE, load_balance
from estimator.rotor.parameter_names import parameter_units
from tests.estimator.statics.test_film_model import document

FILM = ("bearing.B1.clearance", "bearing.B1.viscosity", "films.B1.kxx_deviation0", "disc.D1.unbalance.real")


def test_films_between_couplings_that_are_identified_have_one() -> None:
    assert load_balance(list(parameter_units(parse_machine(document())))) == LOAD_BALANCE


@pytest.mark.parametrize("stiffness", ["coupling.C1.kyy", "coupling.C1.k_phix", "pedestal.P1.kxx"])
def test_one_identified_stiffness_is_enough(stiffness: str) -> None:
    assert load_balance((*FILM, stiffness)) == LOAD_BALANCE


@pytest.mark.parametrize("others", [(), ("coupling.C1.cxx",), ("pedestal.P1.mxx",), ("coupling.C1.kxy",)])
def test_where_no_stiffness_under_the_loads_is_identified_it_does_not_matter(others: tuple[str, ...]) -> None:
    assert load_balance((*FILM, *others)) is None


def test_without_films_it_does_not_matter() -> None:
    assert load_balance(("bearing.B1.kxx", "coupling.C1.kxx", "disc.D1.unbalance.real")) is None
