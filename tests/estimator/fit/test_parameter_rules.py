"""Parameters that the document fixes, believes in or ties together.

On noiseless data a prior moves nothing and adds the inverse square of its spread to the information, so that the
covariance's inverse says what was believed.
"""

import copy
import math
from typing import Any

import numpy as np
import pytest

from estimator.fit.identification import Identification, Options
from estimator.fit.identify import identify
from estimator.machine.document import DocumentError, Machine, parse_machine
from estimator.phasors.measurement import Measurement
from estimator.rotor.condensation import condense
from tests.estimator.full_train import deviations, full_response, true_values
from tests.estimator.trains import Document, Floats, chapter_3, chapter_3_document, noisy, without

SPEED: Floats = np.arange(10.0, 300.0, 2.0)
CLEAN = full_response(chapter_3(), SPEED)
LATERAL = ("kxx", "kxy", "kyx", "kyy", "cxx", "cxy", "cyx", "cyy")


def ruled(*rules: Document, document: Document | None = None) -> Machine:
    return parse_machine({**(document or chapter_3_document()), "parameters": list(rules)})


def noiseless(machine: Machine) -> Identification:
    return identify(machine, Measurement.of(speed=SPEED, phasor=CLEAN))


def measured(machine: Machine | None = None, seed: int = 0) -> Measurement:
    clean = CLEAN if machine is None else full_response(machine, SPEED)
    return Measurement.of(speed=SPEED, phasor=noisy(clean, seed=seed))


def added_information(found: Identification, plain: Identification) -> Floats:
    """Return what the first knows more than the second, by coordinate; between different coordinates it must be nothing."""
    assert found.coordinates == plain.coordinates
    size = np.sqrt(np.diag(plain.covariance))
    known, before = (np.linalg.inv(one.covariance / np.outer(size, size)) for one in (found, plain))
    more = known - before
    apart = more - np.diag(np.diag(more))
    assert np.abs(apart / np.sqrt(np.outer(np.diag(before), np.diag(before)))).max() < 1e-3
    return np.asarray(np.diag(more) / size**2)


def test_fixed_parameters_keep_their_nominal_values() -> None:
    machine = ruled({"names": "coupling.C1.*", "fixed": True}, {"names": "disc.D2.unbalance", "fixed": True})
    found = identify(machine, measured())
    assert found.accepted
    assert len(found.coordinates) == 50 - 10 - 2
    for name in [f"coupling.C1.{n}" for n in (*LATERAL, "k_phix", "k_phiy")] + ["disc.D2.unbalance"]:
        one = found.estimate(name)
        assert not one.estimable
        assert "kept at its nominal value" in (one.reason or "")
    assert found.estimate("coupling.C1.kxx").reason == "kept at its nominal value 212000 N/m"
    free = identify(chapter_3(), measured())
    for one in found.estimates:
        if one.estimable:
            assert (one.standard_error or 0.0) < 1.001 * (free.estimate(one.name).standard_error or 0.0)
    assert np.abs(deviations(found, true_values(chapter_3()))).max() < 4.0


def test_fixed_at_a_wrong_value_is_refused() -> None:
    document = chapter_3_document()
    document["couplings"][0]["kxx"] *= 2.5
    machine = ruled({"names": "coupling.C1.kxx", "fixed": True}, document=document)
    assert not identify(machine, measured(), Options(starts=1)).accepted


def test_covariance_of_fixed_parameters_is_the_conditional_one() -> None:
    plain = noiseless(chapter_3())
    found = noiseless(ruled({"names": "bearing.B3.c*", "fixed": True}))
    kept = [plain.coordinates.index(name) for name in found.coordinates]
    size = np.sqrt(np.diag(plain.covariance))
    information = np.linalg.inv(plain.covariance / np.outer(size, size))
    expected = np.linalg.inv(information[np.ix_(kept, kept)]) * np.outer(size[kept], size[kept])
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(np.sqrt(np.diag(expected)), rel=1e-4)


def test_spread_is_what_the_prior_adds_to_the_information() -> None:
    plain = noiseless(chapter_3())
    found = noiseless(
        ruled(
            {"names": "coupling.C1.k_phi*", "spread": 0.05},
            {"names": "coupling.C1.kxy", "spread": 0.01},
            {"names": "disc.D3.unbalance", "spread": 0.001},
        )
    )
    unbalance = 0.0079 * 0.001
    scale = (212000.0 + 199000.0) / 2
    expected = {
        "coupling.C1.k_phix": 0.05**-2 - math.log(10) ** -2,
        "coupling.C1.k_phiy": 0.05**-2 - math.log(10) ** -2,
        "coupling.C1.kxy": (0.01 * 111000.0) ** -2 - (10 * scale) ** -2,
        "disc.D3.unbalance.real": 2 * unbalance**-2,  # half of the square in either part
        "disc.D3.unbalance.imaginary": 2 * unbalance**-2,
    }
    for name, more, known in zip(
        found.coordinates, added_information(found, plain), np.diag(np.linalg.inv(plain.covariance)), strict=True
    ):
        assert more == pytest.approx(expected.get(name, 0.0), rel=1e-3, abs=1e-3 * known), name
    values = true_values(chapter_3())
    assert np.abs(deviations(found, values)).max() < 1e-3


def test_narrow_spread_holds_a_wrong_value() -> None:
    document = chapter_3_document()
    document["bearings"][0].update(kxx=2.7e5, kxy=1.3e5)
    document["discs"][0]["unbalance"] = {"magnitude": 0.0105, "angle_deg": 40}
    machine = ruled(
        {"names": "bearing.B1.kx*", "spread": 1e-6}, {"names": "disc.D1.unbalance", "spread": 1e-6}, document=document
    )
    found = identify(machine, measured(), Options(starts=1))
    assert not found.accepted
    assert found.estimate("bearing.B1.kxx").value == pytest.approx(2.7e5, rel=1e-4)
    assert found.estimate("bearing.B1.kxy").value == pytest.approx(1.3e5, rel=1e-4)
    one = found.estimate("disc.D1.unbalance")
    assert one.value == pytest.approx(0.0105 * math.cos(math.radians(40)), rel=1e-4)
    assert one.imaginary == pytest.approx(0.0105 * math.sin(math.radians(40)), rel=1e-4)


def test_spread_of_a_cross_coupled_term_that_is_zero_is_part_of_the_direct_terms() -> None:
    document = chapter_3_document()
    document["bearings"][0].update(kxy=0.0, kyx=0.0)
    machine = ruled({"names": "bearing.B1.*", "spread": 0.2}, document=document)
    clean = full_response(machine, SPEED)
    rows = [
        identify(one, Measurement.of(speed=SPEED, phasor=clean))
        for one in (machine, ruled({"names": "bearing.B1.k[xy][xy]", "spread": 0.1}, document=document))
    ]
    # B1's own direct terms: 250 and 275 kN/m.
    place = rows[0].coordinates.index("bearing.B1.kxy")
    assert rows[0].accepted
    more = added_information(rows[1], rows[0])[place]
    assert more == pytest.approx((0.1 * 262500) ** -2 - (0.2 * 262500) ** -2, rel=1e-2)


def test_rules_of_unbalances_leave_bows_and_loads_alone() -> None:
    document = chapter_3_document()
    document["shafts"][0]["bow_spread"] = 1e-4
    document["couplings"][0]["load"] = {"force_spread": 5.0, "moment_spread": 0.5}
    machine = ruled({"names": "*", "fixed": True}, {"names": "*", "spread": 0.5}, document=document)
    train = condense(machine, speed=SPEED[:1], direction=np.ones(1))
    unbalances, others = train.unknowns.excitations[:4], train.unknowns.excitations[4:]
    assert [one.spread for one in unbalances] == pytest.approx([0.5 * abs(one.nominal or 0) for one in unbalances])
    assert [one.spread for one in others] == [1e-4, 5.0, 5.0, 0.5, 0.5]
    fixed = ruled({"names": "*", "fixed": True}, document=document)
    held = condense(fixed, speed=SPEED[:1], direction=np.ones(1)).unknowns.excitations
    assert [one.fixed for one in held] == [True] * 4 + [False] * 5


def twins() -> Document:
    """Chapter 3 with bearing B2 like B1, and B4 like B3."""
    document = chapter_3_document()
    for of, to in ((0, 1), (2, 3)):
        document["bearings"][to].update({name: document["bearings"][of][name] for name in LATERAL})
    return document


def test_tied_bearings_share_their_coefficients() -> None:
    document = twins()
    measurement = measured(parse_machine(document))
    wrong = copy.deepcopy(document)
    wrong["bearings"][1].update(kxx=9e5, kxy=0.0, cyy=1.0)  # what a tied one says itself does not matter
    rules = [{"names": "bearing.B2.*", "tied_to": "bearing.B1"}, {"names": "bearing.B4.*", "tied_to": "bearing.B3"}]
    found = identify(ruled(*rules, document=wrong), measurement)
    assert found.accepted, found.verdict
    assert len(found.coordinates) == 50 - 16
    assert found.estimate("bearing.B2.kxx").reason == "tied to bearing.B1.kxx"
    free = identify(parse_machine(document), measurement)
    expected = true_values(parse_machine(document))
    assert np.abs(deviations(found, expected)).max() < 4.0
    for bearing in ("B1", "B3"):
        for name in LATERAL:
            key = f"bearing.{bearing}.{name}"
            # Two bearings tell of one number: no worse than the better of the two.
            alone = [free.estimate(f"bearing.{b}.{name}").standard_error or 0.0 for b in (bearing, f"B{int(bearing[1]) + 1}")]
            assert (found.estimate(key).standard_error or 0.0) < 1.01 * min(alone), key


def test_tie_of_unequal_bearings_is_refused() -> None:
    machine = ruled({"names": "bearing.B2.*", "tied_to": "bearing.B1"})
    assert not identify(machine, measured(), Options(starts=1)).accepted


def test_tied_to_a_fixed_one() -> None:
    document = twins()
    machine = ruled(
        {"names": "bearing.B1.kxx", "fixed": True}, {"names": "bearing.B2.kxx", "tied_to": "bearing.B1"}, document=document
    )
    document["bearings"][1]["kxx"] = 1.0
    other = ruled(
        {"names": "bearing.B1.kxx", "fixed": True}, {"names": "bearing.B2.kxx", "tied_to": "bearing.B1"}, document=document
    )
    measurement = measured(machine)
    found = identify(other, measurement)
    assert found.accepted
    assert len(found.coordinates) == 48
    assert np.abs(deviations(found, true_values(machine))).max() < 4.0


def test_tied_to_one_that_follows_the_speed() -> None:
    document = twins()
    document["bearings"][2]["speed_dependence"] = {"form": "piecewise", "knots_rpm": [300, 2600], "coefficients": ["kxx"]}
    machine = ruled({"names": "bearing.B4.kxx", "tied_to": "bearing.B3"}, document=document)
    found = identify(machine, measured(parse_machine(twins())))
    assert found.accepted
    expected = {f"bearing.B3.kxx@{knot}rpm": 227000.0 + 0j for knot in (300, 2600)}
    assert np.abs(deviations(found, expected)).max() < 4.0
    # Constant in truth: the response moves as it does when both bearings' constant coefficients move.
    assert len(found.coordinates) == 50


def test_later_rules_win() -> None:
    machine = ruled(
        {"names": "bearing.*", "fixed": True},
        {"names": "bearing.B2.*", "tied_to": "bearing.B1"},
        {"names": "bearing.B2.c*", "spread": 0.3},
    )
    unknown = condense(machine, speed=SPEED[:1], direction=np.ones(1)).unknowns.coefficients
    by_name = {one.name: one for one in unknown}
    assert by_name["bearing.B1.kxx"].fixed
    assert by_name["bearing.B2.kxx"].tied_to == "bearing.B1.kxx"
    assert not by_name["bearing.B2.kxx"].fixed
    damping = by_name["bearing.B2.cxx"]
    assert (damping.fixed, damping.tied_to, damping.spread) == (False, None, 0.3)


NO_DAMPING = without(chapter_3_document(), ("bearings",), ("cxx",))


@pytest.mark.parametrize(
    ("rules", "document", "field", "words"),
    [
        ([{"names": "bearing.B9.*", "fixed": True}], None, "parameters[0].names", "matches no parameter"),
        ([{"names": "shaft.S1.bow", "fixed": True}], None, "parameters[0].names", "matches no parameter"),
        ([{"names": "bearing.B1.*"}], None, "parameters[0]", "exactly one of fixed, spread, tied_to"),
        ([{"names": "*", "fixed": True, "spread": 0.1}], None, "parameters[0]", "exactly one of fixed, spread, tied_to"),
        ([{"names": "*.kxx", "spread": 0.0}], None, "parameters[0].spread", "greater than 0"),
        ([{"names": "bearing.B1.kxx", "tied_to": "bearing.B1"}], None, "parameters[0].tied_to", "tied to itself"),
        (
            [{"names": "bearing.B2.*", "tied_to": "bearing.B9"}],
            None,
            "parameters[0].tied_to",
            "there is no bearing 'B9' to tie to; did you",
        ),
        (
            [{"names": "bearing.B2.*", "tied_to": "pedestal.P7"}],
            None,
            "parameters[0].tied_to",
            "there is no pedestal 'P7' to tie",
        ),
        (
            [{"names": "disc.D2.unbalance", "tied_to": "disc.D1"}],
            None,
            "parameters[0].tied_to",
            "'disc.D1' has no coefficients",
        ),
        ([{"names": "coupling.C1.k_phix", "tied_to": "bearing.B1"}], None, "parameters[0].tied_to", "bearing.B1.k_phix"),
        (
            [{"names": "bearing.B2.kxx", "tied_to": "bearing.B1"}, {"names": "bearing.B3.kxx", "tied_to": "bearing.B2"}],
            None,
            "parameters[1].tied_to",
            "'bearing.B2.kxx' is itself tied",
        ),
        (
            [{"names": "bearing.B1.kxx", "tied_to": "bearing.B2"}, {"names": "bearing.B2.kxx", "tied_to": "bearing.B3"}],
            None,
            "parameters[0].tied_to",
            "'bearing.B2.kxx' is itself tied",
        ),
        ([{"names": "bearing.B1.cxx", "fixed": True}], NO_DAMPING, "parameters[0]", "nominal value of bearing.B1.cxx"),
        ([{"names": "bearing.B1.cxx", "spread": 0.1}], NO_DAMPING, "parameters[0]", "nominal value of bearing.B1.cxx"),
        ([{"names": "disc.D1.*", "fixed": True}], NO_DAMPING, "parameters[0]", "nominal value of disc.D1.unbalance"),
    ],
)
def test_wrong_rule_names_the_field(rules: list[Any], document: Document | None, field: str, words: str) -> None:
    with pytest.raises(DocumentError) as raised:
        ruled(*rules, document=document)
    assert {place for place, _ in raised.value.problems} == {field}
    assert words in raised.value.problems[0][1]


def test_spread_of_an_unbalance_of_nothing_is_no_number() -> None:
    document = chapter_3_document()
    document["discs"][1]["unbalance"] = {"magnitude": 0.0, "angle_deg": 0.0}
    with pytest.raises(DocumentError, match=r"parameters\[0\]: .*disc\.D2\.unbalance.*zero"):
        ruled({"names": "disc.*", "spread": 0.1}, document=document)
    assert ruled({"names": "disc.*", "fixed": True}, document=document).parameters[0].fixed


def test_two_that_take_each_others_place_are_refused() -> None:
    with pytest.raises(DocumentError, match="is itself tied"):
        ruled({"names": "bearing.B1.kxx", "tied_to": "bearing.B2"}, {"names": "bearing.B2.kxx", "tied_to": "bearing.B1"})


def test_rule_that_a_later_one_overrules_does_not_count() -> None:
    ruled(
        {"names": "bearing.B2.kxx", "tied_to": "bearing.B1"},
        {"names": "bearing.B2.kxx", "fixed": True},
        {"names": "bearing.B3.kxx", "tied_to": "bearing.B2"},
    )
    ruled(
        {"names": "bearing.*.cxx", "fixed": True},
        {"names": "bearing.*.cxx", "tied_to": "bearing.B4"},
        {"names": "bearing.B4.cxx", "spread": 1.0},
        document={**NO_DAMPING, "bearings": [*NO_DAMPING["bearings"][:3], chapter_3_document()["bearings"][3]]},
    )
