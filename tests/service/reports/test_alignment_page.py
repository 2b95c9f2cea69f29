"""Changes of alignment in a report: signs, half widths, and chances of which none is certain."""

import pytest

from estimator.alignment.load_change import LoadChange
from estimator.alignment.tolerance import ToleratedChange
from service.reports.alignment_page import alignment_row, load_row
from service.wording.language import ENGLISH, GERMAN, Language


def offset(beyond: float) -> ToleratedChange:
    return ToleratedChange("coupling.C1.offset_vertical", "m", -118.4e-6, 1.25e-6, 50e-6, beyond)


@pytest.mark.parametrize(
    ("beyond", "language", "told"),
    [
        (1.0, ENGLISH, "more than 99 %"),
        (0.9996, ENGLISH, "more than 99 %"),
        (0.96, ENGLISH, "96 %"),
        (0.0, ENGLISH, "less than 1 %"),
        (1.0, GERMAN, "mehr als 99 %"),
        (1e-9, GERMAN, "weniger als 1 %"),
    ],
)
def test_no_chance_of_more_than_allowed_is_certain_and_none_impossible(beyond: float, language: Language, told: str) -> None:
    assert alignment_row(offset(beyond), language)[-1] == told


def test_angles_are_in_milliradians_as_in_trends_and_alerts() -> None:
    angle = ToleratedChange("coupling.C1.angle_vertical", "rad", 612e-6, 51e-6, 370e-6, 0.99)
    assert alignment_row(angle, ENGLISH)[2:5] == ("+0.61 mrad", "0.05 mrad", "0.37 mrad")


def test_changes_have_their_sign_and_the_languages_digits() -> None:
    assert alignment_row(offset(0.5), ENGLISH)[2:5] == ("-118.4 µm", "1.2 µm", "50 µm")
    assert alignment_row(offset(0.5), GERMAN)[2:4] == ("-118,4 µm", "1,2 µm")
    load = LoadChange("bearing.B2.load_vertical", value=420.0, error=30.0, before=6000.0, carried=6010.0)
    assert load_row(load, ENGLISH)[3:] == ("+420 N", "59 N", "+7 %")
