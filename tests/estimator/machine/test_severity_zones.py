"""Zones of severity: their boundaries come from the document, with their source, and hold at a named running speed."""

from typing import Any

import pytest

from estimator.machine.document import DocumentError, parse_machine
from tests.estimator.trains import one_disc_document

ZONES: dict[str, Any] = {"source": "maker's manual, page 12", "a_b": 3e-5, "b_c": 5e-5, "c_d": 8e-5}


def refused(**operation: Any) -> str:
    with pytest.raises(DocumentError) as found:
        parse_machine(one_disc_document() | {"operation": operation})
    return "; ".join(words for _, words in found.value.problems)


def test_a_boundary_belongs_to_the_better_zone() -> None:
    zones = parse_machine(
        one_disc_document() | {"operation": {"running_rpm": 1500, "severity_zones": ZONES}}
    ).operation.severity_zones
    assert zones is not None
    levels = (0.0, 3e-5, 3.1e-5, 5e-5, 8e-5, 8.1e-5)
    assert "".join(zones.zone(level) for level in levels) == "AABBCD"


def test_boundaries_ascend_and_have_a_source_and_a_speed() -> None:
    assert "must ascend" in refused(running_rpm=1500, severity_zones={**ZONES, "b_c": 2e-5})
    assert "must ascend" in refused(running_rpm=1500, severity_zones={**ZONES, "b_c": 8e-5})
    assert "name running_rpm" in refused(severity_zones=ZONES)
    for missing in ZONES:
        assert "required" in refused(running_rpm=1500, severity_zones={k: v for k, v in ZONES.items() if k != missing}).lower()
    assert refused(running_rpm=1500, severity_zones={**ZONES, "source": ""})
