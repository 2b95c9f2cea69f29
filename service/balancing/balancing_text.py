"""Reports a field balancing as text: correction, what it leaves, residual unbalance, and the check run."""

import math
from collections.abc import Iterator

import numpy as np

from estimator.balancing.balance_quality import GRAM_MILLIMETRE, PlaneBalance, RotorBalance
from estimator.balancing.balancing_check import BalancingCheck
from estimator.balancing.field_balancing import FieldBalancing
from estimator.machine.disc_scale import DiscScale
from estimator.units import rad_per_s_to_rpm
from estimator.updated_model.vector_angle import angle_deg
from service.balancing.correction_rows import (
    WeightToAdd,
    effect_rows,
    has_other_weights,
    limit_verdicts,
    plane_weights,
    trim_weights,
)
from service.wording.language import ENGLISH, Language
from service.wording.stored_sentences import in_language

FROM_MARK = DiscScale()
"""Scale that counts from the keyphasor mark, +x to +y."""
SMALL_ANGLE = 10.0
"""Half width from which on it is given in whole degrees [°]."""


def balancing_text(
    found: FieldBalancing,
    check: BalancingCheck | None = None,
    language: Language = ENGLISH,
    scale: DiscScale = FROM_MARK,
) -> str:
    """Return the report of a correction and, where there is one, of its check run, in a language; angles are on a scale."""
    parts = [
        _head(found, language),
        _correction(found, language, scale),
        _effects(found, check, language),
        _residual(found, check, language),
    ]
    if check is not None:
        parts.append(_check(found, check, language, scale))
    return "\n\n".join("\n".join(part) for part in map(list, parts) if part)


def _head(found: FieldBalancing, language: Language) -> Iterator[str]:
    translate = language.translate
    speeds = [f"{rad_per_s_to_rpm(one):.0f}" for one in found.speed]
    shown = ", ".join(speeds)
    if len(speeds) > 6:
        shown = translate("balancing.speeds", count=len(speeds), first=speeds[0], last=speeds[-1])
    yield translate("balancing.title", name=found.machine.name, id=found.machine.id, speeds=shown)
    yield translate("balancing.runs", names=", ".join(found.runs.names))
    yield translate("balancing.influence", words=in_language(found.choice.words, language))
    yield from (translate("balancing.note", words=in_language(one, language)) for one in found.notes)


def _correction(found: FieldBalancing, language: Language, scale: DiscScale) -> Iterator[str]:
    digits, translate = language.digits, language.translate
    counted = "balancing.from_mark" if scale == FROM_MARK else f"balancing.scale.{scale.counted}"
    criterion = translate(f"balancing.{found.correction.criterion}")
    yield translate("balancing.correction", criterion=criterion, scale=translate(counted))
    for one in plane_weights(found):
        yield _weight(found, one, language, scale)
        for place, grams in one.masses:
            yield "      " + translate("balancing.mass", grams=digits(f"{grams:8.4g}"), angle=_reading(found, scale, place))
        if one.missed is not None and one.missed > 0.01:
            yield "      " + translate("balancing.missed", part=100 * one.missed)
    yield translate("balancing.counted")


def _weight(found: FieldBalancing, one: WeightToAdd, language: Language, scale: DiscScale) -> str:
    """Return a plane's unbalance to add with its interval, and its angle on a scale."""
    digits, translate = language.digits, language.translate
    angle = digits(f"{_reading(found, scale, one.angle_deg):6.1f} ± {_half(one.half_width_deg)}")
    interval = translate("balancing.interval", lower=digits(_three(one.lower_g_mm)), upper=digits(_three(one.upper_g_mm)))
    at = translate("balancing.any_angle") if one.half_width_deg >= 180.0 else angle
    return f"  {one.plane:<12} {digits(f'{one.g_mm:10.4g}')} {translate('balancing.at', interval=interval, angle=at)}"


def _half(half: float) -> str:
    """Return the half width of an angle's interval [°], a small one rounded up to the tenths of the angle: none is exact."""
    return f"{half:.0f}" if half >= SMALL_ANGLE else f"{max(math.ceil(10.0 * half) / 10.0, 0.1):.1f}"


def _effects(found: FieldBalancing, check: BalancingCheck | None, language: Language) -> Iterator[str]:
    digits, translate = language.digits, language.translate
    yield translate("balancing.effects") + (translate("balancing.with_check") if check else "")
    promised = "balancing.as_predicted" if check and has_other_weights(found, check) else "balancing.as_promised"
    for one in effect_rows(found, check):
        kept = "" if one.held is None else "  " + translate(promised if one.held else "balancing.more_than_promised")
        shown = "" if one.check is None else f" {digits(f'{one.check:9.3g}')}{kept}"
        yield f"  {one.channel:<12} {digits(f'{one.before:9.3g} {one.after:9.3g} {one.upper:9.3g}')}{shown}"
    limit = limit_verdicts(found)
    if limit is not None:
        yield "  " + translate("balancing.limit", limit=digits(_three(limit[0])), verdict=_verdict_text(limit[1], language))


def _residual(found: FieldBalancing, check: BalancingCheck | None, language: Language) -> Iterator[str]:
    yield language.translate(
        "balancing.residual",
        grade=language.digits(f"{found.options.grade:g}"),
        rpm=rad_per_s_to_rpm(found.service_speed),
        planes=", ".join(found.known.planes),
    ) + (language.translate("balancing.with_check") if check else "")
    states = [found.before, found.after, *([check.residual] if check else [])]
    for rotors in zip(*states, strict=True):
        yield from _planes(rotors, language)


def _planes(rotors: tuple[RotorBalance, ...], language: Language) -> Iterator[str]:
    for planes in zip(*(rotor.planes for rotor in rotors), strict=True):
        states = planes[:1] if planes[0].untold else planes  # what is not known is so in all states
        shown = "; ".join(_plane(one, language) for one in states)
        first = planes[0]
        permissible = language.digits(_three(first.iso_permissible / GRAM_MILLIMETRE))
        told = language.translate("balancing.permissible", amount=permissible, planes=shown)
        yield f"  {rotors[0].shaft:<10} {first.bearing:<8} {told}"


def _plane(one: PlaneBalance, language: Language) -> str:
    if one.untold:
        return language.translate("balancing.untold", why=in_language(one.untold, language))
    return language.translate(
        "balancing.plane",
        amount=language.digits(_g_mm(one.unbalance, one.iso_permissible)),
        upper=language.digits(_three(one.upper / GRAM_MILLIMETRE)),
        grade=language.digits(f"{round(one.grade, 3):.2g}"),
        verdict=_verdict_text(one.iso, language),
    )


def _g_mm(unbalance: complex, permissible: float) -> str:
    """Return an unbalance in g mm with no more digits than the permissible one is looked at with."""
    return _three(round(abs(unbalance) / permissible, 4) * permissible / GRAM_MILLIMETRE)


def _three(value: float) -> str:
    """Return a number with the three digits that count, and without a power of ten."""
    return f"{float(f'{value:.3g}'):.12g}"


def _check(found: FieldBalancing, check: BalancingCheck, language: Language, scale: DiscScale) -> Iterator[str]:
    shown = np.isfinite(check.vector)
    kept, points = int(np.count_nonzero(check.held)), int(np.count_nonzero(shown))
    if check.unpredicted:
        yield language.translate("balancing.check_unpredicted", name=check.name, discs=", ".join(check.unpredicted))
    else:
        yield language.translate("balancing.check", name=check.name, kept=kept, points=points)
    if has_other_weights(found, check):
        yield "  " + language.translate("balancing.other_weights", weights=_installed(found, check, language, scale))
    limit = found.machine.operation.vibration_limit
    if limit is not None:
        kept_limit = bool(np.nanmax(np.abs(check.vector)) <= limit)
        verdict = _verdict_text("met" if kept_limit else "not met", language)
        yield "  " + language.translate("balancing.limit_by_check", verdict=verdict)
    if check.is_trim_noise:
        yield "  " + language.translate("balancing.trim_is_noise")
        return
    yield "  " + language.translate("balancing.trim")
    yield from (_weight(found, one, language, scale) for one in trim_weights(found, check))


def _installed(found: FieldBalancing, check: BalancingCheck, language: Language, scale: DiscScale) -> str:
    """Return the weights that were on in a check run, on the discs' scale."""
    planes = [*found.separation.planes, *check.beside]
    installed = np.array([*check.installed, *check.beside.values()])
    weights = [
        language.digits(f"{plane} {abs(value) / GRAM_MILLIMETRE:.4g} g mm, {_reading(found, scale, angle):.0f}°")
        for plane, value, angle in zip(planes, installed, angle_deg(installed), strict=True)
        if value
    ]
    return "; ".join(weights) or language.translate("balancing.no_weights")


def _reading(found: FieldBalancing, scale: DiscScale, angle_deg: float) -> float:
    """Return the number on the discs' scale of an angle from the keyphasor mark, +x to +y [°]."""
    return scale.reading(math.radians(angle_deg), direction=found.machine.direction)


def _verdict_text(verdict: str, language: Language) -> str:
    said = in_language(verdict, language)
    return said.upper() if verdict == "not met" else said
