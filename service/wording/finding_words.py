"""Words for the places of findings' texts: how far something has changed, in words, and what is left open."""

import math
from collections.abc import Iterator, Mapping, Sequence

from estimator.diagnosis.finding_kind import SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe
from service.wording.described_finding import MILLIRADIANS, DescribedFinding
from service.wording.film_words import (
    alignment_judgement,
    alignment_words,
    settlement_words,
    shown,
    undetermined_alignment,
    wear_words,
)
from service.wording.language import ENGLISH, Language
from service.wording.parameter_words import parameter_words, quantity_words

SIGNIFICANT = 2.0
"""Standard errors from which on a figure beside the first is named [-]."""
UNITS = {"um": "µm", "g mm": "g·mm", "deg": "°", "times": "times"}
"""Units as people write them."""
DIGITS = 3
"""Significant digits of a figure without interval."""


def size_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the size by its figures, as for any finding."""
    return {"size": "; ".join(_figures(finding)) or finding.language.translate("size.unknown")}


def misalignment_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the words on a misalignment and its size."""
    language = finding.language
    if finding.of_films:
        judgement = alignment_judgement(finding.quantities, language)
        return {"judgement": judgement, "size": alignment_words(finding.quantities, language)}
    form = f" ({language.named(finding.form)})" if finding.form else ""
    return {
        "judgement": language.translate("judgement.misaligning", form=form),
        "size": _element_size(finding, of_stiffness=True),
    }


def bearing_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the words on a bearing or a seal and its size; of a film, how far it deviates from its model."""
    times = finding.quantities.get("deviation_times_allowed")
    if times is None:
        kind = finding.language.named(finding.element_kind).capitalize()
        return {
            "judgement": finding.language.translate("judgement.changed", kind=kind, id=finding.id),
            "size": _element_size(finding),
        }
    judgement = finding.language.translate("judgement.film", id=finding.id)
    return {"judgement": judgement, "size": finding.language.translate("size.film", times=times)}


def element_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the growths of an element."""
    return {"size": _element_size(finding)}


def settlement_in_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return where a bearing stands."""
    return {"size": settlement_words(finding.quantities, finding.language)}


def wear_in_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return a clearance's growth."""
    return {"size": wear_words(finding.quantities, finding.language)}


def oil_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the change of the viscosity."""
    parts = list(finding.parts())
    if parts:
        return {"size": interval(parts[0], finding.language)}
    return {"size": f"{finding.quantities['viscosity_per_cent']:+.0f} %"}


def process_force_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return by how much a static force has changed along each axis, and what it was."""
    q, language = finding.quantities, finding.language
    parts = [
        language.translate(
            "size.process_force",
            change=shown(q[f"force_{axis}_n"], CONFIDENCE_95 * q[f"force_{axis}_error_n"], language),
            axis=axis,
            before=q[f"force_{axis}_before_n"],
        )
        for axis in ("x", "y")
        if f"force_{axis}_n" in q
    ]
    return {"size": language.translate("and").join(parts)}


def unbalance_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the change of an unbalance with its angle, and its size before and after."""
    q, parts, language = finding.quantities, list(finding.parts()), finding.language
    change = interval(parts[0], language) if parts else f"{rounded(q['change_g_mm'], DIGITS, language)} g·mm"
    before, after = (rounded(q[name], DIGITS, language) for name in ("before_g_mm", "after_g_mm"))
    angle = whole_degrees(q["change_deg"])
    return {"size": language.translate("size.unbalance", change=change, angle=angle, before=before, after=after)}


def sensor_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the words on a probe's gain and phase since the baseline."""
    q, language = finding.quantities, finding.language
    if not q:
        return {"size": language.translate("size.no_phasors")}
    parts = list(finding.parts())
    whole = language.translate("size.together", whole=interval(parts[0], language)) if parts else ""
    return {"size": language.translate("size.sensor", gain=q["gain_per_cent"], phase=q["phase_deg"], whole=whole)}


def run_out_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the largest change of a run-out."""
    parts = list(finding.parts())
    if parts:
        return {"size": interval(parts[0], finding.language)}
    return {"size": _rounded_length(finding.quantities["largest_um"], finding.language)}


def coupling_run_out_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return the change of a coupling's run-out at bore and face, each with its angle."""
    q, language = finding.quantities, finding.language
    parts = [
        language.translate(f"size.{what}", size=size, angle=whole_degrees(q[f"{name}_deg"]))
        for what, name, size in (
            ("bore", "offset", _rounded_length(q["offset_um"], language) if "offset_um" in q else None),
            ("face", "angle", f"{rounded(MILLIRADIANS * q['angle_urad'], 2, language)} mrad" if "angle_urad" in q else None),
        )
        if size is not None
    ]
    return {"size": language.translate("and").join(parts)}


def rate_words(finding: DescribedFinding) -> Mapping[str, str]:
    """Return a parameter that drifts, and its rate with the 95 % interval."""
    said = finding.evidence
    rate = finding.language.translate(
        "size.rate",
        rate=float(said["per_week_per_cent"]),
        lower=float(said["lower_per_cent"]),
        upper=float(said["upper_per_cent"]),
    )
    return {"parameter": parameter_words(whole_parameter(said["parameter"]), finding.language), "size": rate}


def whole_parameter(name: str) -> str:
    """Return the parameter of a component of a vector."""
    said = describe(name)
    return name if said.component is None else said.whole


def no_questions(_finding: DescribedFinding) -> Sequence[str]:
    """Return nothing: the texts say all that is left open."""
    return ()


def alignment_questions(finding: DescribedFinding) -> Sequence[str]:
    """Return the words on the quantities of an alignment that are not determined."""
    if finding.of_films:
        missing = undetermined_alignment(finding.quantities, finding.language)
        return [*(one[:1].upper() + one[1:] for one in missing), finding.language.translate("open.relative")]
    open_form = () if finding.form else (finding.language.translate("open.form"),)
    return [
        *open_form,
        finding.language.translate("open.films", unit=finding.language.length_unit),
        *element_questions(finding),
    ]


def element_questions(finding: DescribedFinding) -> Sequence[str]:
    """Return the parameters of the element that the newest run does not determine."""
    names = finding.evidence.get("not_estimable") or ()
    said = ", ".join(parameter_words(one, finding.language) for one in names)
    return [finding.language.translate("open.parameters", names=said)] if names else []


def compared_words(finding: DescribedFinding) -> str:
    """Return the words on the runs compared: the newest for alignments on oil films, the mean of several otherwise."""
    runs = finding.evidence.get("runs")
    if finding.of_films or runs is None or runs < 2 or not finding.quantities:
        return finding.language.translate("compared.baseline")
    return finding.language.translate("compared.mean", runs=runs)


def second_order_words(finding: DescribedFinding, next_best: str) -> str:
    """Return how the 2× supports a finding, and whether it was the tie-breaker; empty where it does not."""
    said, language = finding.evidence.get("second_order"), finding.language
    if not said:
        return ""
    before, now = (rounded(language.in_length_unit(said[name]), 2, language) for name in ("before_um", "now_um"))
    unit = language.length_unit
    grown = language.translate("second_order.grown", probe=said["probe"], before=before, now=now, unit=unit)
    key = "second_order.decided" if said["decided"] else "second_order.speaks"
    return language.translate(key, grown=grown, next=next_best)


def part_words(one: SizePart, language: Language = ENGLISH) -> str:
    """Return a figure with its interval and what it is of: `all coefficients of coupling C1 together +53 % (+49 to +57)`."""
    key = "size.part" if one.against == "baseline" else "size.step"
    return language.translate(key, name=part_name(one.name, language), size=interval(one, language))


def part_name(name: str, language: Language = ENGLISH) -> str:
    """Return the words on the element and quantity of a figure."""
    said = describe(name)
    if not said.quantity:  # of the machine as a whole
        return language.named(said.element_id or said.element)
    element = language.element(said.element)
    if said.quantity == "coefficients":
        return language.translate("size.all_coefficients", element=element)
    return language.translate("size.of_element", quantity=quantity_words(said.quantity, language), element=element)


def interval(one: SizePart, language: Language = ENGLISH) -> str:
    """Return a figure with its unit and 95 % interval."""
    unit = language.named(UNITS.get(one.unit, one.unit))
    if one.before is not None:
        places = _decimals((one.upper - one.lower) / 2.0)
        before, after = (language.digits(f"{each:.{places}f}") for each in (one.before, one.before + one.value))
        lower, upper = (language.digits(f"{each:+.{places}f}") for each in (one.lower, one.upper))
        return language.translate("size.from_to", before=before, after=after, unit=unit, lower=lower, upper=upper)
    if one.unit == "%":
        places = 1 if one.upper - one.lower < 2.0 else 0
        value, lower, upper = (language.digits(f"{each:+.{places}f}") for each in (one.value, one.lower, one.upper))
        return language.translate("size.per_cent_interval", value=value, lower=lower, upper=upper)
    return f"{shown(one.value, (one.upper - one.lower) / 2.0, language)} {unit}"


def _decimals(half: float) -> int:
    """Return the decimals with which a figure is as sharp as half its interval; an interval of nothing has three."""
    return 3 if half <= 0.0 else min(9, max(0, -math.floor(math.log10(half))))


def whole_degrees(angle: float) -> int:
    """Return an angle [°] to a degree, from 0 to 359."""
    return round(angle) % 360


def rounded(value: float, digits: int, language: Language = ENGLISH) -> str:
    """Return a number with so many significant digits in plain notation: nobody reads 1.3e+04 g·mm aloud."""
    shown_value = float(f"{value:.{digits}g}")
    decimals = 0 if shown_value == 0.0 else max(0, digits - 1 - math.floor(math.log10(abs(shown_value))))
    return language.digits(f"{shown_value:.{decimals}f}")


def _rounded_length(micrometres: float, language: Language) -> str:
    return f"{rounded(language.in_length_unit(micrometres), 2, language)} {language.length_unit}"


def described_parts(finding: DescribedFinding) -> Iterator[SizePart]:
    """Yield the figures that are stated: the first, and all others that are certain."""
    for number, one in enumerate(finding.parts()):
        if number == 0 or one.sigma is None or abs(one.sigma) >= SIGNIFICANT:
            yield one


def _figures(finding: DescribedFinding) -> Iterator[str]:
    for one in described_parts(finding):
        yield part_words(one, finding.language)


def _element_size(finding: DescribedFinding, *, of_stiffness: bool = False) -> str:
    """Return the growths of elements: of each once, where all its coefficients have grown together."""
    figures = [part_words(one, finding.language) for one in described_parts(finding) if one.before is None]
    if figures:
        return "; ".join(figures)
    # An older release has stored means without intervals.
    described = [(describe(name), value) for name, value in finding.quantities.items()]
    if of_stiffness:
        parts = [f"{own.element} {value:+.0f} %" for own, value in described if own.quantity == "stiffness_per_cent"]
        return finding.language.translate("size.stiffness", parts=", ".join(parts))
    named = [(finding.language.named(own.quantity.removesuffix("_per_cent")), value) for own, value in described]
    return ", ".join(f"{name} {value:+.0f} %" for name, value in named)
