"""Summary of what a comparison of runs with a baseline finds: its text, and the columns of its data frame."""

from typing import Any

from estimator.alignment.alignment_comparison import AlignmentComparison
from estimator.fit.estimates import Estimate
from estimator.fit.identification import Identification
from estimator.identification.model_comparison import ModelComparison
from rotorundown.summaries.estimate_words import estimate_words


def comparison_text(comparison: ModelComparison, baseline: Identification) -> str:
    """Return the verdict, the compared models and the best one's values at the coupling, beside those of the baseline."""
    lines = [comparison.verdict, "", "Compared models, the likeliest first: the smaller the criterion, the likelier"]
    lines += [
        f"  {view.name:<22} criterion {view.criterion:10.1f}  unknowns {view.unknowns:3d}  {view.identification.verdict}"
        for view in comparison.views
    ]
    shown = coupling_estimates(comparison)
    if shown:
        lines += ["", f"At the coupling, by the model '{comparison.views[0].name}': the later value, and the baseline's"]
    before = {one.name: f"; before {one.value:+.4e}" for one in baseline.estimates if one.value is not None}
    width = max((len(one.name) for one in shown), default=0)
    return "\n".join(lines + [f"  {one.name:<{width}}  {estimate_words(one)}{before.get(one.name, '')}" for one in shown])


def coupling_estimates(comparison: ModelComparison) -> list[Estimate]:
    """Return the best model's estimates at the coupling and the bearings beside it."""
    best = comparison.views[0].identification
    return [one for one in best.estimates if one.element in comparison.elements and one.quantity != "unbalance"]


def coupling_rows(comparison: ModelComparison, baseline: Identification) -> list[dict[str, Any]]:
    """Return each estimate at the coupling beside that of the baseline, and the change, in SI units."""
    known = {one.name: one for one in baseline.estimates}
    rows = []
    for one in coupling_estimates(comparison):
        before = known.get(one.name)
        old = None if before is None else before.value
        change = None if one.value is None or old is None else one.value - old
        rows.append(
            {
                "parameter": one.name,
                "before": old,
                "before_standard_error": None if before is None else before.standard_error,
                "value": one.value,
                "standard_error": one.standard_error,
                "change": change,
                "change_per_cent": 100.0 * change / abs(old) if change is not None and old else None,
                "unit": one.unit,
                "reason": one.reason,
            }
        )
    return rows


def alignment_rows(comparison: AlignmentComparison) -> list[dict[str, Any]]:
    """Return the changes of offsets, angles and loads on films with their 95 % intervals, in SI units."""
    changes = [
        {
            "parameter": one.name,
            "change": one.value,
            "lower": None if one.value is None else one.value - one.half,
            "upper": None if one.value is None else one.value + one.half,
            "allowed": one.allowed,
            "before": None,
            "change_per_cent": None,
            "unit": one.unit,
            "reason": one.reason,
        }
        for one in comparison.changes
    ]
    loads = [
        {
            "parameter": one.name,
            "change": one.value,
            "lower": one.value - one.half,
            "upper": one.value + one.half,
            "allowed": None,
            "before": one.before,
            "change_per_cent": None if one.part is None else 100.0 * one.part,
            "unit": "N",
            "reason": None,
        }
        for one in comparison.loads
    ]
    return changes + loads
