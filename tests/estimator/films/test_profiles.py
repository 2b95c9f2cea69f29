"""Profiles of bearings and their pads."""

import math

import pytest

from estimator.films.pad import FULL_ARC, InvalidPad, Pad
from estimator.films.profiles import BearingProfile, elliptical, four_lobe, lobed, plain, three_lobe, two_axial_grooves


def degrees(profile: BearingProfile) -> list[tuple[int, int]]:
    """Start and end of each pad [°]."""
    return [(round(math.degrees(pad.start)), round(math.degrees(pad.start + pad.arc))) for pad in profile.pads]


def test_pads_lie_between_their_grooves() -> None:
    assert plain().pads[0].is_full
    assert degrees(two_axial_grooves()) == [(-170, -10), (10, 170)]
    assert degrees(elliptical(preload=0.5, groove=math.radians(30))) == [(-165, -15), (15, 165)]
    assert degrees(two_axial_grooves(split=math.radians(45))) == [(-125, 35), (55, 215)]
    assert degrees(three_lobe(preload=0.3)) == [(-140, -40), (-20, 80), (100, 200)]
    assert degrees(four_lobe(preload=0.3)) == [(-80, -10), (10, 80), (100, 170), (190, 260)]


def test_a_preload_brings_the_pad_closer_where_it_says() -> None:
    assert Pad(-math.pi, math.pi, 0.4).closing == pytest.approx((0.0, -0.4))
    assert Pad(-math.pi, math.pi, 0.4, math.pi).closing == pytest.approx((-0.4, 0.0))


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (lambda: Pad(0.0, 0.05), "a pad of 2.86.*6 to 360"),
        (lambda: Pad(0.0, 1.0, 1.0), "a preload of 1: it must be 0 to 0.9"),
        (lambda: Pad(0.0, FULL_ARC, 0.2), "needs two pads"),
        (lambda: Pad(0.0, 2.0, continuous=True), "only one of 360°"),
        (lambda: lobed(4, preload=0.2, groove=1.6, first=0.0), "narrower than 84°"),
        (lambda: elliptical(preload=0.5, groove=0.0), "wider than 0"),
        (lambda: BearingProfile(()), "at least one"),
        (lambda: BearingProfile((Pad(0.0, 4.0), Pad(4.0, 4.0))), "more than 360"),
    ],
)
def test_what_no_bearing_has_is_refused(made: object, said: str) -> None:
    assert callable(made)
    with pytest.raises(InvalidPad, match=said):
        made()
