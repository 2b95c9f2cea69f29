"""A store of the release before the rooms: opened, answered from as that release answered, and gone on with."""

import gzip
import json
from pathlib import Path
from typing import Any

import pytest

from tests.end_to_end.processes import DATA, EXAMPLES, Service, process, until

MACHINE = "thesis-chapter-3"
AGE = frozenset({"age_s", "silent_s"})
"""Fields that say how long ago something was."""


WORDED = frozenset({"message", "moved"})
"""Fields that are made of stored numbers anew, and in per cent."""


def without_age(value: Any) -> Any:
    """Return an answer without what depends on when it is asked for."""
    if isinstance(value, dict):
        return {name: without_age(one) for name, one in value.items() if name not in AGE}
    return [without_age(one) for one in value] if isinstance(value, list) else value


def nearly(value: Any) -> Any:
    """Return what equals an answer though another processor rounds the last digit otherwise."""
    if isinstance(value, dict):
        return {name: nearly(one) for name, one in value.items()}
    if isinstance(value, list):
        return [nearly(one) for one in value]
    return pytest.approx(value, rel=1e-12, abs=0.0) if isinstance(value, float) else value


def known_before(now: dict[str, Any], then: dict[str, Any]) -> dict[str, Any]:
    """Return an answer without the fields that have come since."""
    return {
        name: known_before(now[name], one) if isinstance(one, dict) and isinstance(now[name], dict) else now[name]
        for name, one in then.items()
    }


def told_alike(now: Any, then: Any) -> Any:
    """Return an answer as that release gave it: without fields that have come since, and what is put into words anew."""
    if isinstance(now, list) and isinstance(then, list) and len(now) == len(then):
        return [told_alike(one, other) for one, other in zip(now, then, strict=True)]
    if isinstance(now, dict) and isinstance(then, dict):
        return {name: told_alike(now.get(name), one) if name not in WORDED else one for name, one in then.items()}
    return now


def test_it_is_answered_as_before_and_gone_on_with(tmp_path: Path) -> None:
    (tmp_path / "rundown.db").write_bytes(gzip.decompress((DATA / "store-before-rooms.db.gz").read_bytes()))
    before: dict[str, Any] = json.loads(gzip.decompress((DATA / "store-before-rooms.json.gz").read_bytes()))
    service = Service(tmp_path)
    with service.client, service.running():
        identified = before[f"/machines/{MACHINE}/identifications"]
        for path, answer in before.items():
            now = service.client.get(path).json()
            if path.endswith(("/runs", "/identifications")):
                now = [one for one in now if one["id"] in {old["id"] for old in answer}]
            if path.endswith("/limits"):  # kinds of findings and measures of limits have come since
                now["limits"] = known_before(now["limits"], answer["limits"])
            if path not in ("/machines", f"/machines/{MACHINE}", f"/machines/{MACHINE}/deviations"):
                now = told_alike(now, answer)
                assert without_age(now) == nearly(without_age(answer)), path
        # What comes now is numbered, collected and identified behind what was there.
        truth = tmp_path / "truth.jsonl"
        flags = ["--cycles", "1", "--samples", "40", "--rate", "120", "--seed", "5", "--truth", str(truth)]
        with process(
            tmp_path / "simulate.log", "simulate", f"{EXAMPLES / MACHINE}.yaml", *flags, "--connect", service.endpoint
        ) as one:
            assert one.wait(60) == 0
        newest = f"/machines/{MACHINE}/identifications"
        until(lambda: len(service.get(newest)) > len(identified), within_s=90, what="a new identification")
