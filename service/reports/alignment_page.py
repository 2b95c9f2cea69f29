"""The part of a report that tells how the couplings' alignment and the bearings' loads have changed against the baseline."""

from estimator.alignment.alignment_change import changed_alignment
from estimator.alignment.load_change import LoadChange, changed_loads
from estimator.alignment.run_change import run_change
from estimator.alignment.tolerance import ToleratedChange, tolerated_changes
from estimator.diagnosis.moving_causes import moving_causes
from estimator.machine.film_speeds import follows_films
from estimator.machine.parameter_description import describe
from service.reports.contents import ReportContents, ReportedFit
from service.reports.page_parts import muted, table
from service.wording.film_words import signed_change
from service.wording.finding_words import rounded
from service.wording.language import Language
from service.wording.stored_sentences import in_language

MICRO, MILLI = 1e6, 1e3
LEAST_CHANCE, MOST_CHANCE = 1, 99
"""Chances that are told as a number [%]: none is certain, and none impossible."""
ALIGNMENT_COLUMNS = ("coupling", "quantity", "change", "half_width", "allowed", "beyond")
LOAD_COLUMNS = ("bearing", "quantity", "load_before", "change", "half_width", "load_part")


def alignment_page(contents: ReportContents, fit: ReportedFit) -> str:
    """Return the changes of alignment and loads, as API and alert tell them; or why there are none."""
    language = contents.language
    if not fit.one.machine.couplings:
        return ""
    if not follows_films(fit.one.machine):
        return muted(language.translate("report.no_offsets"))
    if not fit.baseline:
        return muted(language.translate("report.not_compared", reason=in_language(fit.missing, language)))
    models = [one.model_beside(()) for one in fit.baseline]
    if any(one.coordinates != fit.one.model.coordinates for one in models):
        return muted(language.translate("report.other_unknowns"))
    change = run_change(models, fit.one.model_beside(fit.causes), causes=moving_causes(fit.causes))
    if change is None:
        return ""
    changes = tolerated_changes(fit.one.machine, changed_alignment(change))
    alignment = [alignment_row(one, language) for one in changes]
    loads = [load_row(one, language) for one in changed_loads(change)]
    return "".join(
        table([language.translate(f"report.{one}") for one in columns], rows)
        for columns, rows in ((ALIGNMENT_COLUMNS, alignment), (LOAD_COLUMNS, loads))
        if rows
    )


def alignment_row(one: ToleratedChange, language: Language) -> tuple[str, ...]:
    """Return the cells of a change of an offset or an angle, in the order of `ALIGNMENT_COLUMNS`."""
    said = describe(one.name)
    unit, scale = (language.length_unit, language.in_length_unit(MICRO)) if one.unit == "m" else ("mrad", MILLI)
    allowed = f"{rounded(scale * one.allowed, 2, language)} {unit}"
    quantity = language.named(said.quantity)
    if one.value is None:
        missing = language.translate("report.not_determined", reason=in_language(one.reason or "", language))
        return said.element_id, quantity, missing, "–", allowed, "–"
    change, half = signed_change(scale * one.value, scale * one.half, language)
    return said.element_id, quantity, f"{change} {unit}", f"{half} {unit}", allowed, _chance(one.beyond, language)


def load_row(one: LoadChange, language: Language) -> tuple[str, ...]:
    """Return the cells of a change of a load, in the order of `LOAD_COLUMNS`."""
    said = describe(one.name)
    change, half = signed_change(one.value, one.half, language)
    part = "–" if one.part is None else language.digits(f"{100.0 * one.part:+.0f} %")
    before = f"{rounded(one.before, 3, language)} N"
    return said.element_id, language.named(said.quantity), before, f"{change} N", f"{half} N", part


def _chance(value: float, language: Language) -> str:
    """Return a chance in per cent: none is certain, and none impossible."""
    part = 100.0 * value
    if part > MOST_CHANCE:
        return language.translate("report.chance_above", part=MOST_CHANCE)
    return language.translate("report.chance_below", part=LEAST_CHANCE) if part < LEAST_CHANCE else f"{part:.0f} %"
