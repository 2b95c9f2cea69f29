"""Size and form of a cause against its baseline, as its kind of finding declares them."""

from collections.abc import Mapping

from estimator.diagnosis.baseline_reference import Reference
from estimator.diagnosis.finding_kind import BaselineValues, Cause, ChangeSize
from estimator.diagnosis.finding_kinds import finding_kind


def change_size(cause: Cause, baseline: Reference, *, amplitude: Mapping[str, float]) -> ChangeSize:
    """Return the size of a cause against its baseline.

    Args:
        cause: The cause.
        baseline: The baseline.
        amplitude: Median amplitude by channel in the baseline [m].

    Returns:
        The size.
    """
    size = finding_kind(cause.kind).size
    if size is None:
        return ChangeSize(None)
    return size(cause, BaselineValues(dict(zip(baseline.names, baseline.mean, strict=True)), amplitude))


def change_form(cause: Cause) -> str | None:
    """Return the form of a cause, such as `parallel` of a misalignment.

    Args:
        cause: The cause.

    Returns:
        The form; None where there is none or the data do not tell.
    """
    form = finding_kind(cause.kind).form
    return None if form is None else form(cause)
