"""Words for the places of findings' texts: how far something has changed, in words, and what is left open."""

import math
from collections.abc import Iterator, Mapping, Sequence

from estimator.diagnosis.finding_kind import SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe
from service.wording.described_finding import ToldFinding
from service.wording.film_words import (
    alignment_judgement,
    alignment_words,
    settlement_words,
    shown,
    undetermined_alignment,
    wear_words,
)
from service.wording.language import ENGLISH, Language

SIGNIFICANT = 2.0
"""Standard errors from which on a figure beside the first is named [-]."""
UNITS = {"um": "µm", "urad": "µrad", "g mm": "g·mm", "deg": "°", "times": "times"}
"""Units as people write them."""
DIGITS = 3
"""Significant digits of a figure without interval."""


def size_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the size by its figures, as any finding can be told."""
    return {"size": "; ".join(_figures(told)) or told.language.say("size.unknown")}


def misalignment_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the words on a misalignment and its size."""
    language = told.language
    if told.of_films:
        judgement = alignment_judgement(told.quantities, language)
        return {"judgement": judgement, "size": alignment_words(told.quantities, language)}
    form = f" ({language.named(told.form)})" if told.form else ""
    return {"judgement": language.say("judgement.misaligning", form=form), "size": _element_size(told, of_stiffness=True)}


def bearing_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the words on a bearing or a seal and its size; of a film, how far it deviates from its model."""
    times = told.quantities.get("deviation_times_allowed")
    if times is None:
        kind = told.language.named(told.element_kind).capitalize()
        return {"judgement": told.language.say("judgement.changed", kind=kind, id=told.id), "size": _element_size(told)}
    judgement = told.language.say("judgement.film", id=told.id)
    return {"judgement": judgement, "size": told.language.say("size.film", times=times)}


def element_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the growths of an element."""
    return {"size": _element_size(told)}


def settlement_size(told: ToldFinding) -> Mapping[str, str]:
    """Return where a bearing stands."""
    return {"size": settlement_words(told.quantities, told.language)}


def wear_size(told: ToldFinding) -> Mapping[str, str]:
    """Return a clearance's growth."""
    return {"size": wear_words(told.quantities, told.language)}


def oil_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of the viscosity."""
    parts = list(told.parts())
    if parts:
        return {"size": interval(parts[0], told.language)}
    return {"size": f"{told.quantities['viscosity_per_cent']:+.0f} %"}


def process_force_words(told: ToldFinding) -> Mapping[str, str]:
    """Return by how much a static force has changed along each axis, and what it was."""
    q, language = told.quantities, told.language
    parts = [
        language.say(
            "size.process_force",
            change=shown(q[f"force_{axis}_n"], CONFIDENCE_95 * q[f"force_{axis}_error_n"], language),
            axis=axis,
            before=q[f"force_{axis}_before_n"],
        )
        for axis in ("x", "y")
        if f"force_{axis}_n" in q
    ]
    return {"size": language.say("and").join(parts)}


def unbalance_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of an unbalance with its angle, and its size before and after."""
    q, parts, language = told.quantities, list(told.parts()), told.language
    change = interval(parts[0], language) if parts else f"{rounded(q['change_g_mm'], DIGITS, language)} g·mm"
    before, after = (rounded(q[name], DIGITS, language) for name in ("before_g_mm", "after_g_mm"))
    return {"size": language.say("size.unbalance", change=change, angle=q["change_deg"], before=before, after=after)}


def sensor_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the words on a probe's gain and phase since the baseline."""
    q, language = told.quantities, told.language
    if not q:
        return {"size": language.say("size.no_phasors")}
    parts = list(told.parts())
    whole = language.say("size.together", whole=interval(parts[0], language)) if parts else ""
    return {"size": language.say("size.sensor", gain=q["gain_per_cent"], phase=q["phase_deg"], whole=whole)}


def run_out_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the largest change of a run-out."""
    parts = list(told.parts())
    if parts:
        return {"size": interval(parts[0], told.language)}
    return {"size": f"{rounded(told.quantities['largest_um'], 2, told.language)} µm"}


def coupling_run_out_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of a coupling's run-out at bore and face, each with its angle."""
    q, language = told.quantities, told.language
    parts = [
        language.say(f"size.{what}", size=rounded(q[f"{name}_{unit}"], 2, language), unit=UNITS[unit], angle=q[f"{name}_deg"])
        for what, name, unit in (("bore", "offset", "um"), ("face", "angle", "urad"))
        if f"{name}_{unit}" in q
    ]
    return {"size": language.say("and").join(parts)}


def rate_words(told: ToldFinding) -> Mapping[str, str]:
    """Return a parameter that drifts, and its rate with the 95 % interval."""
    said = told.evidence
    rate = told.language.say(
        "size.rate",
        rate=float(said["per_week_per_cent"]),
        lower=float(said["lower_per_cent"]),
        upper=float(said["upper_per_cent"]),
    )
    return {"parameter": whole_parameter(said["parameter"]), "size": rate}


def whole_parameter(name: str) -> str:
    """Return the parameter of a component of a vector."""
    said = describe(name)
    return name if said.component is None else said.whole


def no_questions(_told: ToldFinding) -> Sequence[str]:
    """Return nothing: the texts say all that is left open."""
    return ()


def alignment_questions(told: ToldFinding) -> Sequence[str]:
    """Return the words on the quantities of an alignment that are not determined."""
    if told.of_films:
        missing = undetermined_alignment(told.quantities, told.language)
        return [*(one[:1].upper() + one[1:] for one in missing), told.language.say("open.relative")]
    open_form = () if told.form else (told.language.say("open.form"),)
    return [*open_form, told.language.say("open.films"), *element_questions(told)]


def element_questions(told: ToldFinding) -> Sequence[str]:
    """Return the parameters of the element that the newest run does not determine."""
    names = told.evidence.get("not_estimable") or ()
    return [told.language.say("open.parameters", names=", ".join(names))] if names else []


def compared_words(told: ToldFinding) -> str:
    """Return the words on the runs compared: the newest for alignments on oil films, the mean of several otherwise."""
    runs = told.evidence.get("runs")
    if told.of_films or runs is None or runs < 2 or not told.quantities:
        return told.language.say("compared.baseline")
    return told.language.say("compared.mean", runs=runs)


def second_order_words(told: ToldFinding, next_best: str) -> str:
    """Return how the 2× speaks for a finding, and whether it has decided for it; empty where it says nothing."""
    said, language = told.evidence.get("second_order"), told.language
    if not said:
        return ""
    before, now = (rounded(said[name], 2, language) for name in ("before_um", "now_um"))
    grown = language.say("second_order.grown", probe=said["probe"], before=before, now=now)
    key = "second_order.decided" if said["decided"] else "second_order.speaks"
    return language.say(key, grown=grown, next=next_best)


def part_words(one: SizePart, language: Language = ENGLISH) -> str:
    """Return a figure with its interval and what it is of: `all coefficients of coupling C1 together +53 % (+49 to +57)`."""
    return f"{part_name(one.name, language)} {interval(one, language)}"


def part_name(name: str, language: Language = ENGLISH) -> str:
    """Return the words on the element and quantity of a figure."""
    said = describe(name)
    if not said.quantity:  # of the machine as a whole
        return language.named(said.element_id or said.element)
    element = language.element(said.element)
    if said.quantity == "coefficients":
        return language.say("size.all_coefficients", element=element)
    return language.say("size.of_element", quantity=language.named(said.quantity), element=element)


def interval(one: SizePart, language: Language = ENGLISH) -> str:
    """Return a figure with its unit and 95 % interval."""
    unit = language.named(UNITS.get(one.unit, one.unit))
    if one.before is not None:
        low, high = sorted((abs(one.before), abs(one.before + one.value)))
        digits = max(2, 1 - math.floor(math.log10(max(high - low, 1e-9) / max(high, 1e-9))))
        return f"{rounded(one.before, digits, language)} → {rounded(one.before + one.value, digits, language)} {unit}"
    if one.unit == "%":
        places = 1 if one.upper - one.lower < 2.0 else 0
        value, lower, upper = (language.digits(f"{each:+.{places}f}") for each in (one.value, one.lower, one.upper))
        return language.say("size.per_cent_interval", value=value, lower=lower, upper=upper)
    return f"{shown(one.value, (one.upper - one.lower) / 2.0, language)} {unit}"


def rounded(value: float, digits: int, language: Language = ENGLISH) -> str:
    """Return a number with so many significant digits in plain notation: nobody reads 1.3e+04 g·mm aloud."""
    shown_value = float(f"{value:.{digits}g}")
    decimals = 0 if shown_value == 0.0 else max(0, digits - 1 - math.floor(math.log10(abs(shown_value))))
    return language.digits(f"{shown_value:.{decimals}f}")


def told_parts(told: ToldFinding) -> Iterator[SizePart]:
    """Yield the figures that are told: the first, and the others that are certain."""
    for number, one in enumerate(told.parts()):
        if number == 0 or one.sigma is None or abs(one.sigma) >= SIGNIFICANT:
            yield one


def _figures(told: ToldFinding) -> Iterator[str]:
    for one in told_parts(told):
        yield part_words(one, told.language)


def _element_size(told: ToldFinding, *, of_stiffness: bool = False) -> str:
    """Return the growths of elements: of each once, where all its coefficients have grown together."""
    figures = [part_words(one, told.language) for one in told_parts(told) if one.before is None]
    if figures:
        return "; ".join(figures)
    # An older release has stored means without intervals.
    described = [(describe(name), value) for name, value in told.quantities.items()]
    if of_stiffness:
        parts = [f"{own.element} {value:+.0f} %" for own, value in described if own.quantity == "stiffness_per_cent"]
        return told.language.say("size.stiffness", parts=", ".join(parts))
    named = [(told.language.named(own.quantity.removesuffix("_per_cent")), value) for own, value in described]
    return ", ".join(f"{name} {value:+.0f} %" for name, value in named)
