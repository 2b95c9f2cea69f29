"""Tests what is made of a report of pip-audit: a vulnerability fails, and no answer is not taken for none."""

from benchmarks.dependency_audit import judged

CLEAN = {"name": "numpy", "version": "2.0", "vulns": []}
SKIPPED = {"name": "scipy", "skip_reason": "Dependency not found on PyPI and could not be audited: scipy (1.2)"}
OWN = {"name": "rotorundown", "skip_reason": "distribution marked as editable"}
VULNERABLE = {"name": "jinja", "version": "1.0", "vulns": [{"id": "CVE-2030-1", "fix_versions": ["1.1"], "aliases": []}]}


def test_a_vulnerability_is_named_with_its_cure() -> None:
    found = judged({"dependencies": [CLEAN, VULNERABLE, OWN]})
    assert found.found == ["jinja 1.0: CVE-2030-1, fixed in 1.1"]
    assert found.words.startswith("VULNERABLE")


def test_none_found_is_said_with_what_was_looked_at() -> None:
    found = judged({"dependencies": [CLEAN, SKIPPED, OWN]})
    assert (found.found, found.looked_up, found.others) == ([], 1, ["scipy"])
    assert found.words == "no known vulnerability in 1 packages; not known there: scipy"


def test_no_answer_is_not_taken_for_none() -> None:
    assert judged({"dependencies": [SKIPPED, OWN]}).words.startswith("NOT AUDITED")
