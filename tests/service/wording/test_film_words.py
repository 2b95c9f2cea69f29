"""Sentences about trains on oil films: which way, how far, what is allowed, what is not determined."""

from service.wording.described_finding import DescribedFinding
from service.wording.film_words import (
    alignment_judgement,
    alignment_words,
    settlement_words,
    shown,
    undetermined_alignment,
    wear_words,
)
from service.wording.language import Language

OFFSET = {
    "allowed_at_rpm": 3600.0,
    "offset_vertical_um": -120.4,
    "offset_vertical_half_width_um": 18.2,
    "offset_vertical_allowed_um": 50.0,
    "offset_horizontal_um": 3.0,
    "offset_horizontal_half_width_um": 9.0,
    "offset_horizontal_allowed_um": 50.0,
}
ANGLE = {"angle_vertical_urad": 90.0, "angle_vertical_half_width_urad": 30.0, "angle_vertical_allowed_urad": 370.0}


def test_an_alarm_says_how_far_how_sure_and_what_is_allowed() -> None:
    loads = {"bearing.B1.load_per_cent": 0.4, "bearing.B2.load_per_cent": 7.2, "bearing.B3.load_per_cent": -6.1}
    numbers = OFFSET | loads | {"bearing.B3.vertical_um": -80.3}
    assert alignment_judgement(numbers) == "is out of alignment"
    assert alignment_words(numbers) == (
        "the driven shaft lies 120 ± 18 µm lower (allowed 50 µm at 3600 r/min); "
        "the angle is not determined; bearing B2 carries 7 % more, B3 6 % less; the same as bearing B3 80 µm lower"
    )
    assert undetermined_alignment(numbers) == ["the angle is not determined"]


def test_lengths_are_reported_in_mils_where_the_reader_asked_for_them() -> None:
    mils = Language("en", "mil")
    assert alignment_words(OFFSET | ANGLE | {"bearing.B3.vertical_um": -80.3}, mils) == (
        "the driven shaft lies 4.7 ± 0.7 mil lower (allowed 1.97 mil at 3600 r/min); it rises more from the coupling on, by "
        "0.09 ± 0.03 mrad (allowed 0.37 mrad); the horizontal angle is not determined; the same as bearing B3 3.16 mil lower"
    )
    wear = {"clearance_per_cent": 15.0, "clearance_error_per_cent": 1.0, "before_um": 69.0, "after_um": 79.0}
    assert wear_words(wear, mils) == "15.0 ± 2.0 % larger, 3.11 mil in place of 2.72 mil"
    assert settlement_words({"vertical_um": -60.0, "vertical_error_um": 0.2}, mils) == "2.362 ± 0.015 mil lower"


def test_what_is_within_tolerance_has_changed() -> None:
    small = OFFSET | {"offset_vertical_um": 20.0, "offset_vertical_half_width_um": 4.0}
    assert alignment_judgement(small | ANGLE) == "has changed its alignment"
    assert alignment_words(small | ANGLE) == (
        "the driven shaft lies 20 ± 4 µm higher (allowed 50 µm at 3600 r/min); "
        "it rises more from the coupling on, by 0.09 ± 0.03 mrad (allowed 0.37 mrad); the horizontal angle is not determined"
    )


def test_a_step_is_told_where_it_differs_from_the_change_since_the_baseline() -> None:
    small = OFFSET | ANGLE | {"offset_vertical_um": -9.0, "offset_vertical_half_width_um": 3.2}
    step = {"step_offset_vertical_um": -18.0, "step_offset_vertical_half_width_um": 2.1}
    told = alignment_words(small | step)
    assert told.startswith("the driven shaft lies 9 ± 3 µm lower (allowed 50 µm at 3600 r/min); it rises more")
    assert "; compared with the runs just before the change, 18 ± 2 µm lower; " in told
    assert "gegenüber den Läufen unmittelbar vor der Änderung 18 ± 2 µm tiefer" in alignment_words(
        small | step, Language("de")
    )
    assert "runs just before" not in alignment_words(small | step | {"step_offset_vertical_um": -9.5})
    turned = {"step_angle_vertical_urad": -200.0, "step_angle_vertical_half_width_urad": 30.0}
    assert (
        "compared with the runs just before the change, it rises less from the coupling on, by 0.20 ± 0.03 mrad"
        in alignment_words(small | turned)
    )


def test_other_findings_have_their_own_units() -> None:
    settled = {"vertical_um": -60.0, "vertical_error_um": 5.0, "horizontal_um": 2.0, "horizontal_error_um": 5.0}
    assert settlement_words(settled) == "60 ± 10 µm lower"
    worn = {"clearance_per_cent": 15.4, "clearance_error_per_cent": 1.5, "before_um": 69.0, "after_um": 79.0}
    assert wear_words(worn) == "15 ± 3 % larger, 79 µm in place of 69 µm"


def test_digits_follow_the_interval() -> None:
    assert [shown(12.345, half) for half in (12.0, 1.24, 0.12)] == ["12 ± 12", "12.3 ± 1.2", "12.35 ± 0.12"]


def test_sizes_keep_their_unit_unless_the_reader_asked_for_mils() -> None:
    """The API gives sizes in the unit that their names say; only who asked for mils gets them."""
    size = {
        "name": "coupling.C1.offset_vertical",
        "unit": "um",
        "value": -118.0,
        "lower": -136.0,
        "upper": -100.0,
        "members": [],
    }
    evidence = {"parts": [size]}
    assert [one.unit for one in DescribedFinding("misalignment", "coupling.C1", evidence).parts()] == ["um"]
    (mils,) = DescribedFinding("misalignment", "coupling.C1", evidence, Language("en", "mil")).parts()
    assert (mils.unit, round(mils.value, 2)) == ("mil", -4.65)
