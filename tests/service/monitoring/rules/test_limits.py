"""Limits: what a level needs, how a level is left, which documents contradict themselves or do not suit a machine."""

from typing import Any, get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from estimator.diagnosis.finding_kind import ElementKind
from service.alerts.lifecycle import Severity
from service.monitoring.rules.limits import DEFAULTS, Limits, LimitsRefused, RuleName, require_suited, severity_of
from tests.plant import document, few_examples, machine

PATIENT = {"alert": {"sigma": 4, "per_cent": 10}, "danger": {"per_cent": 30}, "hysteresis": 0.2}
FOUND = st.one_of(st.none(), st.floats(-1e3, 1e3))


def limits(**rules: Any) -> Limits:
    return Limits.model_validate(rules)


def test_a_change_must_be_both_certain_and_large() -> None:
    of = limits(bearing=PATIENT)
    assert severity_of(of, "bearing", sigma=3.9, per_cent=50.0) is None
    assert severity_of(of, "bearing", sigma=50.0, per_cent=9.9) is None
    assert severity_of(of, "bearing", sigma=4.0, per_cent=10.0) is Severity.ALERT
    assert severity_of(of, "bearing", sigma=-4.0, per_cent=-30.0) is Severity.DANGER
    assert severity_of(of, "bearing", sigma=None, per_cent=50.0) is None


def test_sizes_are_alternatives() -> None:
    of = limits(misalignment={"alert": {"sigma": 3, "per_cent": 5, "force": 200}, "danger": {"force": 900}})
    assert severity_of(of, "misalignment", sigma=5.0, per_cent=1.0, force=250.0) is Severity.ALERT
    assert severity_of(of, "misalignment", sigma=5.0, per_cent=6.0, force=None) is Severity.ALERT
    assert severity_of(of, "misalignment", sigma=5.0, per_cent=1.0, force=900.0) is Severity.DANGER
    assert severity_of(of, "misalignment", sigma=1.0, per_cent=1.0, force=900.0) is None


def test_a_level_may_ask_for_certainty_alone() -> None:
    of = limits(coupling={"alert": {"sigma": 5}, "danger": None})
    assert severity_of(of, "coupling", sigma=5.1) is Severity.ALERT
    assert severity_of(of, "coupling", sigma=4.9, per_cent=90.0) is None


def test_a_level_is_left_only_below_its_hysteresis() -> None:
    of = limits(bearing=PATIENT)

    def held(per_cent: float, present: Severity | None) -> Severity | None:
        return severity_of(of, "bearing", sigma=9.0, per_cent=per_cent, present=present)

    assert held(9.0, None) is None
    assert held(9.0, Severity.ALERT) is Severity.ALERT
    assert held(7.9, Severity.ALERT) is None
    assert held(25.0, Severity.ALERT) is Severity.ALERT
    assert held(25.0, Severity.DANGER) is Severity.DANGER
    assert held(23.9, Severity.DANGER) is Severity.ALERT


def test_the_rate_of_change_has_limits_of_its_own() -> None:
    of = limits(rate_of_change={"alert": {"rate_per_cent_per_week": 1}, "danger": {"rate_per_cent_per_week": 4}})
    assert [severity_of(of, "rate_of_change", rate=rate) for rate in (0.9, -1.0, 4.0)] == [
        None,
        Severity.ALERT,
        Severity.DANGER,
    ]


def test_an_element_may_have_limits_of_its_own() -> None:
    of = limits(elements={"bearing.B2": {"bearing": {"alert": {"per_cent": 50}}}})
    assert severity_of(of, "bearing", sigma=9.0, per_cent=30.0, element="bearing.B2") is None
    assert severity_of(of, "bearing", sigma=9.0, per_cent=30.0, element="bearing.B3") is Severity.DANGER
    assert of.rule("coupling", "bearing.B2") == of.rule("coupling")


@few_examples
@given(sigma=FOUND, per_cent=FOUND, grown=st.floats(1.0, 10.0), present=st.sampled_from([None, *Severity]))
def test_a_larger_change_is_never_less_severe(
    sigma: float | None, per_cent: float | None, grown: float, present: Severity | None
) -> None:
    of = limits(bearing=PATIENT)

    def rank(by: float) -> int:
        larger = [None if value is None else by * value for value in (sigma, per_cent)]
        return int(severity_of(of, "bearing", sigma=larger[0], per_cent=larger[1], present=present) or 0)

    assert rank(grown) >= rank(1.0)


@few_examples
@given(sigma=FOUND, per_cent=FOUND)
def test_what_was_reached_before_is_held_at_least(sigma: float | None, per_cent: float | None) -> None:
    of = limits(bearing=PATIENT)
    ranks = [
        int(severity_of(of, "bearing", sigma=sigma, per_cent=per_cent, present=present) or 0) for present in (None, *Severity)
    ]
    assert ranks == sorted(ranks)


@pytest.mark.parametrize("kind", get_args(ElementKind))
def test_limits_may_be_of_a_finding_at_any_kind_of_element(kind: ElementKind, monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine as a whole has no part that could have limits of its own."""
    monkeypatch.setattr("service.monitoring.rules.limits.concerned_elements", lambda _: (kind,))
    require_suited(Limits(), machine())
    if parts := [] if kind == "machine" else getattr(machine(), f"{kind}s"):
        own = {f"{kind}.{parts[0].id}": {"bearing": {"alert": {"per_cent": 5}, "danger": {"per_cent": 50}}}}
        require_suited(limits(elements=own), machine())
    with pytest.raises(LimitsRefused):
        require_suited(limits(elements={"machine.pump-7": {"bearing": {"alert": {"per_cent": 5}}}}), machine())


def test_defaults_name_what_a_person_leaves_out() -> None:
    of = limits(misalignment={"on_delay": 3})
    assert of.rule("misalignment") == DEFAULTS["misalignment"].model_copy(update={"on_delay": 3})
    assert of.rule("bearing") == DEFAULTS["bearing"]
    assert Limits.model_validate(of.model_dump(mode="json")) == of


@pytest.mark.parametrize(
    ("rules", "said"),
    [
        ({"misalignment": {"alert": {"per_cent": 20}}}, "danger.per_cent 15 lies below alert.per_cent 20"),
        ({"bearing": {"alert": {"sigma": 4}, "danger": {"sigma": 3, "per_cent": 9}}}, "danger.sigma 3 lies below"),
        ({"bearing": {"alert": {"sigma": 4}, "danger": {"sigma": 4}}}, "the same as alert"),
        ({"bearing": {"alert": {}}}, "alert names no limit"),
        ({"bearing": {"danger": {}}}, "danger names no limit"),
        ({"bearing": {"alert": {"per_cent": 0}}}, "greater than 0"),
        ({"bearing": {"alert": {"per_cent": -3}}}, "greater than 0"),
        ({"bearing": {"alert": {"per_cent": float("nan")}}}, "finite"),
        ({"bearing": {"alert": {"sigma": float("inf")}}}, "finite"),
        ({"bearing": {"alert": {"sigma": 101}}}, "less than or equal to 100"),
        ({"bearing": {"hysteresis": 1.0}}, "less than or equal to 0.9"),
        ({"bearing": {"on_delay": 0}}, "greater than or equal to 1"),
        ({"bearing": {"off_delay": 21}}, "less than or equal to 20"),
        ({"bearing": {"alert": {"force": 100}}}, "alert.force is no limit of bearing: it has sigma, per_cent"),
        ({"rate_of_change": {"alert": {"per_cent": 3}}}, "alert.per_cent is no limit of rate_of_change"),
        ({"gearbox": {"alert": {"per_cent": 3}}}, "Extra inputs are not permitted"),
        ({"bearing": {"alert": {"percent": 3}}}, "Extra inputs are not permitted"),
        ({"bearing": 3}, "dictionary or instance of Rule"),
        ({"elements": {"bearing.B2": {"bearing": {"alert": {"force": 1}}}}}, "alert.force is no limit of bearing"),
        ({"elements": {"bearing.B2": {"gearbox": {"alert": {"sigma": 1}}}}}, "Input should be 'misalignment'"),
    ],
)
def test_a_document_that_contradicts_itself_is_refused(rules: dict[str, Any], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        limits(**rules)


@pytest.mark.parametrize("name", list(DEFAULTS))
def test_every_default_can_be_reached(name: RuleName) -> None:
    assert severity_of(Limits(), name, sigma=99.0, per_cent=1e4, rate=1e4, tolerance_per_cent=1e4) is not None
    assert severity_of(Limits(), name, sigma=0.1, per_cent=0.1, rate=0.01, tolerance_per_cent=0.1) is None


def test_a_force_needs_a_coupling_that_carries_it() -> None:
    one_shaft = document(couplings=[])
    for part in ("shafts", "discs", "bearings", "probes"):
        one_shaft[part] = [item for item in one_shaft[part] if item.get("shaft", item["id"]) == "S1"]
    require_suited(Limits(), machine(**one_shaft))
    forced = limits(misalignment={"danger": {"force": 900}})
    require_suited(forced, machine())
    with pytest.raises(LimitsRefused, match="has no coupling that could carry a force"):
        require_suited(forced, machine(**one_shaft))


@pytest.mark.parametrize(
    ("element", "rule", "said"),
    [
        ("bearing.B9", "bearing", "'bearing.B9' is not an element of machine 'pump-7': bearing.B1, "),
        ("coupling.C1", "bearing", "bearing speaks of bearings and seals"),
    ],
)
def test_limits_of_what_a_machine_has_not_are_refused(element: str, rule: str, said: str) -> None:
    with pytest.raises(LimitsRefused, match=said):
        require_suited(limits(elements={element: {rule: {"alert": {"per_cent": 5}}}}), machine())
