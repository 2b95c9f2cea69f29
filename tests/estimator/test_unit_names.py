"""Units by the names that people, instruments and the tool itself give them."""

import pytest

from estimator.unit_names import UNIT_NAMES, declared_unit, unknown_unit


@pytest.mark.parametrize(
    ("field", "name", "unit"),
    [
        ("speed_unit", "r/min", "rpm"),
        ("speed_unit", "RPM", "rpm"),
        ("speed_unit", "min⁻¹", "rpm"),
        ("speed_unit", " hz ", "Hz"),
        ("amplitude_unit", "\N{MICRO SIGN}m", "um"),
        ("amplitude_unit", "\N{GREEK SMALL LETTER MU}m", "um"),
        ("amplitude_unit", "mils", "mil"),
        ("amplitude_kind", "pp", "peak-to-peak"),
        ("amplitude_kind", "p-p", "peak-to-peak"),
        ("amplitude_kind", "pk-pk", "peak-to-peak"),
        ("amplitude_kind", "peak to peak", "peak-to-peak"),
        ("amplitude_kind", "0-pk", "peak"),
        ("phase_unit", "°", "deg"),
        ("phase_convention", "LEAD", "lead"),
        ("gap_unit", "µm", "um"),
        ("weight_unit", "g·mm", "g mm"),
        ("weight_unit", "oz-in", "oz in"),
        ("radius_unit", "inch", "in"),
    ],
)
def test_a_name_stands_for_a_unit(field: str, name: str, unit: str) -> None:
    assert declared_unit(field, name) == unit


def test_each_unit_stands_for_itself_and_no_name_for_two() -> None:
    for field, units in UNIT_NAMES.items():
        for unit, names in units.items():
            assert [declared_unit(field, one) for one in (unit, *names)] == [unit] * (len(names) + 1)


def test_what_is_no_name_of_a_unit_stays_and_is_told_close_ones() -> None:
    assert declared_unit("speed_unit", "herz") == "herz"
    assert declared_unit("speed_unit", None) is None
    assert unknown_unit("speed_unit", "herz", ["rpm", "Hz"]) == "'herz' is not one of rpm, Hz; did you mean 'Hz'?"
    assert unknown_unit("amplitude_unit", "in", ["m", "mm", "um", "mil"]) == "'in' is not one of m, mm, um, mil"
    assert unknown_unit("amplitude_unit", "volts", ["m", "um"]) == "'volts' is not one of m, um"
    assert unknown_unit("phase_unit", 360, ["deg", "rad"]) == "360 is not one of deg, rad"
