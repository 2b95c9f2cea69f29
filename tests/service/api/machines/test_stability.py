"""Stability asked of the API: trains that would whirl or touch, in the words of `rundown check`, computed once a revision."""

from typing import Any

import pytest
import yaml

from estimator.machine.document import parse_machine
from estimator.statics.whirl_in_range import instability_words
from service.api.cache.model_process import NotComputed
from service.api.machines import stability
from tests.api_in_process import PREFIX, Api, problem
from tests.paths import EXAMPLES
from tests.plant import document

QUIET: dict[str, Any] = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
"""A train on oil films that would run."""
WHIRLS = QUIET | {"speed_range": QUIET["speed_range"] | {"maximum_rpm": 6000}}
TOUCHES = QUIET | {"static_loads": [{"id": "gear", "shaft": "S2", "station": 1.46, "force_y": -2.0e6}]}


def asked(api: Api, given: dict[str, Any]) -> list[str]:
    """The warnings of a document, which is created or revised first."""
    if api.get(f"/machines/{given['id']}").status_code == 404:
        api("POST", "/machines", 201, json=given)
    else:
        api("PUT", f"/machines/{given['id']}", json=given)
    found = api.value(f"/machines/{given['id']}/stability")
    revision = api.value(f"/machines/{given['id']}")["revision"]
    assert (found["machine"], found["revision"]) == (given["id"], revision)
    return list(found["warnings"])


def test_each_revision_on_oil_films_is_judged_by_itself(api: Api) -> None:
    assert asked(api, QUIET) == []
    words = instability_words(parse_machine(WHIRLS))
    assert "the train would whirl from" in words
    assert asked(api, WHIRLS) == [f"bearings: {words}"]
    (touching,) = asked(api, TOUCHES)
    assert touching.startswith("bearings: at ")
    assert "on bearing 'B4', whose journal touches first, at rest are" in touching


def test_a_revision_is_computed_once(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    computed: list[str] = []

    def counted(machine: Any) -> str:
        computed.append(machine.id)
        return instability_words(machine)

    monkeypatch.setattr(stability, "instability_words", counted)
    assert [asked(api, document()) for _ in range(3)] == [[], [], []]
    assert computed == ["pump-7"]
    cross = [one | {"kxy": 3 * one["kxx"], "kyx": -3 * one["kxx"]} for one in document()["bearings"]]
    (words,) = asked(api, document(bearings=cross))
    assert "bearings: at 3000 r/min a mode would grow (damping ratio -" in words
    assert computed == ["pump-7", "pump-7"]


def test_without_films_no_other_process_is_asked(api: Api, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: Any) -> None:
        raise NotComputed("it was busy")

    monkeypatch.setattr(api.app.state.model_process, "compute", refuse)
    assert asked(api, document()) == []
    api("POST", "/machines", 201, json=QUIET)
    assert "it was busy" in problem(api.get(f"/machines/{QUIET['id']}/stability"), 503)["detail"]


def test_a_machine_that_is_not_there_has_none(api: Api) -> None:
    assert "GET /api/v1/machines lists" in problem(api.ask("GET", f"{PREFIX}/machines/no-such/stability"), 404)["detail"]
