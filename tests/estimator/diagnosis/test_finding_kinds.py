"""Kinds of findings: a declaration that lacks a part is refused where it is made."""

from collections.abc import Iterator

import numpy as np
import pytest

from estimator.diagnosis.change_columns import ChangeColumns
from estimator.diagnosis.data_faults import lost_channels
from estimator.diagnosis.finding_kind import BaselineValues, Cause, ChangeSize, ExpectedChange, FindingKind
from estimator.diagnosis.finding_kinds import FINDING_KINDS, finding_kind


def changes(columns: ChangeColumns) -> Iterator[ExpectedChange]:
    yield ExpectedChange("disc.D1", (np.zeros((len(columns.names), 1)),))


def size(_cause: Cause, _baseline: BaselineValues) -> ChangeSize:
    return ChangeSize(None)


def test_what_nothing_would_find_is_refused() -> None:
    with pytest.raises(ValueError, match="'rub' has no changes, data_fault or fit_fault"):
        FindingKind("rub", ("disc",), "machine", size=size)


def test_changes_without_a_size_are_refused() -> None:
    with pytest.raises(ValueError, match="'rub' has changes and no size"):
        FindingKind("rub", ("disc",), "machine", changes=changes)
    assert FindingKind("rub", ("disc",), "machine", changes=changes, size=size).size is size


def test_a_finding_lies_somewhere() -> None:
    with pytest.raises(ValueError, match="names no kinds of elements"):
        FindingKind("rub", (), "data", data_fault=lost_channels)
    with pytest.raises(ValueError, match="'rub' names shafft, which is no kind of element"):
        FindingKind("rub", ("shafft",), "data", data_fault=lost_channels)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"'unbalance' is declared for disc, not for 'bearing.B1'"):
        finding_kind("unbalance").require_element("bearing.B1")


def test_each_kind_is_declared_once() -> None:
    kinds = [one.kind for one in FINDING_KINDS]
    assert len(set(kinds)) == len(kinds) == 18
    assert [one.kind for one in FINDING_KINDS if one.linear] == ["unbalance", "rotating_coupling", "run_out"]
    with pytest.raises(KeyError):
        finding_kind("rub")
