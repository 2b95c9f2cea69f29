"""Adds the finding "rub": a shaft that touches its casing."""

from tests.additions.addition import LANGUAGE_TESTS, Addition
from tests.additions.package_copy import PackageCopy

CHECK = """
from estimator.diagnosis.finding_kinds import finding_kind
from service.commands.page_declarations import documents
from service.monitoring.rules.finding_catalogue import finding_rule, concerned_elements
from service.monitoring.rules.limits import Limits
assert concerned_elements(finding_rule("rub").rule) == ("shaft",)
assert Limits().rule("rub", "shaft.S1").alert.sigma == 3.0
assert '"rub"' in documents()["findings.ts"]
assert '"rub": "Anstreifen"' in documents()["findings.ts"]
assert '"rub"' in OPENAPI
"""


def _add(copy: PackageCopy) -> None:
    copy.insert(
        "estimator/diagnosis/finding_kinds.py",
        "FINDING_KINDS: tuple[FindingKind, ...] = (",
        '\n    FindingKind("rub", ("shaft",), "machine", changes=_bows, size=_run_out_size),',
    )
    copy.insert(
        "service/monitoring/rules/rotor_findings.py",
        "ROTOR_FINDINGS: tuple[FindingRule, ...] = (",
        '\n    FindingRule("rub", AlertRule("rub", Rule(alert=Level(sigma=3.0)), ("sigma",)), {"de": "Anstreifen"}, '
        '{"en": FindingTexts("Shaft {id} rubs: {size}", ("a",), ("b",), ("c",), (), ("e",), ("f",)), '
        '"de": FindingTexts("Welle {id} streift an: {size}", ("g",), ("h",), ("i",), (), ("k",), ("l",))}),',
    )


FINDING = Addition("finding", most_files=2, add=_add, check=CHECK, tests=LANGUAGE_TESTS)
