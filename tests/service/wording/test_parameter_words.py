"""Names of parameters and derived quantities in words, in both languages."""

import pytest

from service.wording.language import ENGLISH, GERMAN
from service.wording.parameter_words import parameter_words


@pytest.mark.parametrize(
    ("name", "english", "german"),
    [
        ("material.steel.density", "density of material steel", "Dichte von Werkstoff steel"),
        ("bearing.B1.journal_x", "journal x of bearing B1", "Zapfen x von Lager B1"),
        ("bearing.B1.viscosity_slope", "viscosity slope of bearing B1", "Temperaturgang der Viskosität von Lager B1"),
        ("bearing.B1.kxx_scale", "scale of kxx of bearing B1", "Faktor auf kxx von Lager B1"),
        ("coupling.C1.k_phix", "kφx of coupling C1", "kφx von Kupplung C1"),
        ("probe.P1.second_phase", "2× phase of probe P1", "2×, Phase von Aufnehmer P1"),
        ("critical_speed.1", "critical speed 1", "kritische Drehzahl 1"),
    ],
)
def test_a_quantity_is_told_in_words(name: str, english: str, german: str) -> None:
    assert parameter_words(name, ENGLISH) == english
    assert parameter_words(name, GERMAN) == german
