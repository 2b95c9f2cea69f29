"""Names of classes: each stands for one thing in the packages and the benchmarks."""

import ast
from collections import defaultdict

from tests.imports import ROOT


def test_no_two_classes_have_one_name() -> None:
    found = defaultdict[str, list[str]](list)
    for package in ("estimator", "storage", "service", "rotorundown", "benchmarks"):
        for path in sorted((ROOT / package).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ClassDef):
                    found[node.name].append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert len(found) > 500
    assert {name: places for name, places in found.items() if len(places) > 1} == {}
