"""Words for the places of findings' texts: how far something has changed, in words, and what is left open."""

import math
from collections.abc import Iterator, Mapping, Sequence

from estimator.diagnosis.finding_kind import SizePart
from estimator.fit.estimates import CONFIDENCE_95
from estimator.machine.parameter_description import describe
from service.wording.film_words import (
    alignment_judgement,
    alignment_words,
    settlement_words,
    shown,
    undetermined_alignment,
    wear_words,
)
from service.wording.told_finding import ToldFinding

SIGNIFICANT = 2.0
"""Standard errors from which on a figure beside the first is named [-]."""
UNITS = {"um": "µm", "urad": "µrad", "g mm": "g·mm", "deg": "°", "times": "times"}
"""Units as people write them."""
DIGITS = 3
"""Significant digits of a figure without interval."""


def size_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the size by its figures, as any finding can be told."""
    return {"size": "; ".join(_figures(told)) or "by an unknown amount"}


def misalignment_words(told: ToldFinding) -> Mapping[str, str]:
    """Return what is said of a misalignment, and its size."""
    if told.of_films:
        return {"judgement": alignment_judgement(told.quantities), "size": alignment_words(told.quantities)}
    form = f" ({told.form})" if told.form else ""
    return {"judgement": f"is going out of alignment{form}", "size": _element_size(told, of_stiffness=True)}


def bearing_words(told: ToldFinding) -> Mapping[str, str]:
    """Return what is said of a bearing or a seal, and its size; of a film, how far it deviates from its model."""
    times = told.quantities.get("deviation_times_allowed")
    if times is None:
        kind = told.element_kind.capitalize()
        return {"judgement": f"{kind} {told.id} has changed by itself", "size": _element_size(told)}
    judgement = f"The oil film of bearing {told.id} has changed, and neither by wear nor by oil nor by load"
    return {
        "judgement": judgement,
        "size": f"its coefficients deviate {times:.1f} times as far from the model as its document says",
    }


def element_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the growths of an element."""
    return {"size": _element_size(told)}


def settlement_size(told: ToldFinding) -> Mapping[str, str]:
    """Return where a bearing stands."""
    return {"size": settlement_words(told.quantities)}


def wear_size(told: ToldFinding) -> Mapping[str, str]:
    """Return a clearance's growth."""
    return {"size": wear_words(told.quantities)}


def oil_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of the viscosity."""
    parts = list(told.parts())
    return {"size": interval(parts[0]) if parts else f"{told.quantities['viscosity_per_cent']:+.0f} %"}


def process_force_words(told: ToldFinding) -> Mapping[str, str]:
    """Return by how much a static force has changed along each axis, and what it was."""
    q = told.quantities
    axes = [(axis, f"force_{axis}") for axis in ("x", "y") if f"force_{axis}_n" in q]
    parts = [
        f"by {shown(q[f'{name}_n'], CONFIDENCE_95 * q[f'{name}_error_n'])} N along {axis}, from {q[f'{name}_before_n']:.0f} N"
        for axis, name in axes
    ]
    return {"size": " and ".join(parts)}


def unbalance_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of an unbalance with its angle, and its size before and after."""
    q, parts = told.quantities, list(told.parts())
    change = interval(parts[0]) if parts else f"{rounded(q['change_g_mm'], DIGITS)} g·mm"
    before, after = (rounded(q[name], DIGITS) for name in ("before_g_mm", "after_g_mm"))
    return {"size": f"{change} at {q['change_deg']:.0f}°, from {before} to {after} g·mm"}


def sensor_words(told: ToldFinding) -> Mapping[str, str]:
    """Return what a probe does now."""
    q = told.quantities
    if not q:
        return {"size": "gives no usable phasors any more"}
    parts = list(told.parts())
    whole = f" (together {interval(parts[0])})" if parts else ""
    return {"size": f"or its chain reads differently: gain {q['gain_per_cent']:+.0f} %, phase {q['phase_deg']:+.0f}°{whole}"}


def run_out_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the largest change of a run-out."""
    parts = list(told.parts())
    return {"size": interval(parts[0]) if parts else f"{rounded(told.quantities['largest_um'], 2)} µm"}


def coupling_run_out_words(told: ToldFinding) -> Mapping[str, str]:
    """Return the change of a coupling's run-out at bore and face, each with its angle."""
    q = told.quantities
    parts = [
        f"{what} by {rounded(q[f'{name}_{unit}'], 2)} {shown} at {q[f'{name}_deg']:.0f}°"
        for what, name, unit, shown in (("bore", "offset", "um", "µm"), ("face", "angle", "urad", "µrad"))
        if f"{name}_{unit}" in q
    ]
    return {"size": " and ".join(parts)}


def rate_words(told: ToldFinding) -> Mapping[str, str]:
    """Return a parameter that drifts, and its rate with the 95 % interval."""
    said = told.evidence
    rate = f"{said['per_week_per_cent']:+.2g} % a week ({said['lower_per_cent']:+.2g} to {said['upper_per_cent']:+.2g})"
    return {"parameter": whole_parameter(said["parameter"]), "size": rate}


def whole_parameter(name: str) -> str:
    """Return the parameter of a component of a vector."""
    said = describe(name)
    return name if said.component is None else said.whole


def no_questions(_told: ToldFinding) -> Sequence[str]:
    """Return nothing: the texts say all that is left open."""
    return ()


def alignment_questions(told: ToldFinding) -> Sequence[str]:
    """Return what is left open of an alignment."""
    if told.of_films:
        beyond = "All of it is relative to the baseline: what was off then is not seen"
        return [*(one.capitalize() for one in undetermined_alignment(told.quantities)), beyond]
    open_form = () if told.form else ("Whether it is parallel or angular",)
    films = "Offset in µm and angle in mrad: only trains whose document describes the oil films by geometry tell them"
    return [*open_form, films, *element_questions(told)]


def element_questions(told: ToldFinding) -> Sequence[str]:
    """Return the parameters of the element that the newest run does not determine."""
    names = told.evidence.get("not_estimable") or ()
    return [f"{', '.join(names)}: not determined one by one by the newest run"] if names else []


def compared_words(told: ToldFinding) -> str:
    """Return what is compared: alignments on oil films are those of the newest run, other sizes the mean of several."""
    runs = told.evidence.get("runs")
    if told.of_films or runs is None or runs < 2 or not told.quantities:
        return "against the baseline"
    return f"mean of the newest {runs} runs against the baseline"


def second_order_words(told: ToldFinding, next_best: str) -> str:
    """Return how the 2× speaks for a finding, and whether it has decided for it; empty where it says nothing."""
    said = told.evidence.get("second_order")
    if not said:
        return ""
    grown = (
        f"the 2× at probe {said['probe']} has grown from {rounded(said['before_um'], 2)} to {rounded(said['now_um'], 2)} µm, "
        "as beside a misaligned coupling, and at no probe elsewhere (common practice)"
    )
    if said["decided"]:
        return f"; by 1× alone {next_best} explains it about as well: it is named because {grown}"
    return f"; {grown}, which speaks for it rather than for the next explanation"


def part_words(one: SizePart) -> str:
    """Return a figure with its interval and what it is of: `all coefficients of coupling C1 together +53 % (+49 to +57)`."""
    return f"{part_name(one.name)} {interval(one)}"


def part_name(name: str) -> str:
    """Return what a figure is of."""
    said = describe(name)
    if not said.quantity:  # of the machine as a whole
        return said.element_id or said.element
    element = f"{said.element_kind} {said.element_id}"
    if said.quantity == "coefficients":
        return f"all coefficients of {element} together"
    words = said.quantity.replace("_", " ")
    return f"{words} of {element}"


def interval(one: SizePart) -> str:
    """Return a figure with its unit and 95 % interval."""
    unit = UNITS.get(one.unit, one.unit)
    if one.before is not None:
        low, high = sorted((abs(one.before), abs(one.before + one.value)))
        digits = max(2, 1 - math.floor(math.log10(max(high - low, 1e-9) / max(high, 1e-9))))
        return f"{rounded(one.before, digits)} → {rounded(one.before + one.value, digits)} {unit}"
    if one.unit == "%":
        places = 1 if one.upper - one.lower < 2.0 else 0
        return f"{one.value:+.{places}f} % ({one.lower:+.{places}f} to {one.upper:+.{places}f})"
    return f"{shown(one.value, (one.upper - one.lower) / 2.0)} {unit}"


def rounded(value: float, digits: int) -> str:
    """Return a number with so many significant digits in plain notation: nobody reads 1.3e+04 g·mm aloud."""
    shown_value = float(f"{value:.{digits}g}")
    decimals = 0 if shown_value == 0.0 else max(0, digits - 1 - math.floor(math.log10(abs(shown_value))))
    return f"{shown_value:.{decimals}f}"


def told_parts(told: ToldFinding) -> Iterator[SizePart]:
    """Yield the figures that are told: the first, and the others that are certain."""
    for number, one in enumerate(told.parts()):
        if number == 0 or one.sigma is None or abs(one.sigma) >= SIGNIFICANT:
            yield one


def _figures(told: ToldFinding) -> Iterator[str]:
    for one in told_parts(told):
        yield part_words(one)


def _element_size(told: ToldFinding, *, of_stiffness: bool = False) -> str:
    """Return the growths of elements: of each once, where all its coefficients have grown together."""
    figures = [part_words(one) for one in told_parts(told) if one.before is None]
    if figures:
        return "; ".join(figures)
    # An older release has stored means without intervals.
    described = [(describe(name), value) for name, value in told.quantities.items()]
    if of_stiffness:
        parts = [f"{own.element} {value:+.0f} %" for own, value in described if own.quantity == "stiffness_per_cent"]
        return f"stiffness {', '.join(parts)}"
    return ", ".join(f"{own.quantity.removesuffix('_per_cent')} {value:+.0f} %" for own, value in described)
