"""The bill of materials names this release; `make sbom` writes it from a fresh installation."""

import json

from benchmarks.sbom import with_version
from rotorundown.environment.release import VERSION


def test_the_main_component_has_its_version() -> None:
    bill = {"bomFormat": "CycloneDX", "metadata": {"component": {"name": "rotorundown"}}, "components": []}
    assert with_version(json.loads(json.dumps(bill)))["metadata"] == {"component": {"name": "rotorundown", "version": VERSION}}
