"""Names of parameters and derived quantities in words, in both languages."""

from typing import get_args

import pytest

from estimator.diagnosis.finding_kind import ElementKind
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
        ("probe.P1.second_phase", "2× phase of probe P1", "2×-Phase von Aufnehmer P1"),
        ("probe.P1.run_out", "run-out of probe P1", "Runout von Aufnehmer P1"),
        ("static_load.F1.force_x", "part along x of static force F1", "Anteil in x von Prozesskraft F1"),
        ("coupling.C1.rotating_angle", "run-out of the face of coupling C1", "Planlauffehler von Kupplung C1"),
        ("critical_speed.1", "critical speed 1", "kritische Drehzahl 1"),
    ],
)
def test_a_quantity_is_reported_in_words(name: str, english: str, german: str) -> None:
    assert parameter_words(name, ENGLISH) == english
    assert parameter_words(name, GERMAN) == german


def test_german_elements_are_nouns_alone() -> None:
    """Sentences put them behind prepositions: an adjective would need another ending in each case."""
    kinds = (*get_args(ElementKind), "material")
    assert [one for one in kinds if " " in GERMAN.named(one) or not GERMAN.named(one)[0].isupper()] == []
