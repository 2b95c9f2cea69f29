"""Tests what was identified since a cursor, in all formats, and trends as line protocol."""

import csv
import io
import re
from typing import Any

import httpx
import pandas
import pytest
from arro3.io import read_parquet

from service.api.trends import filed as filed_module
from storage.database.engine import Database
from storage.findings import filed_estimates
from storage.machines import machines
from tests.api_in_process import PREFIX, Api
from tests.paths import ROOT
from tests.plant import KEY, START, identification, machine, store_identification


def stored(plant: Database, *runs: int) -> list[int]:
    """Identifications of some runs, as if they had been filed long ago."""
    found = []
    with plant.transaction() as session:
        for run in runs:
            row = store_identification(session, identification(), run_id=run, measured_at=START + run * 10**9)
            row.computed_at -= filed_estimates.HELD_BACK_NS
            found.append(row.id)
    return found


def test_a_reader_gets_everything_once_page_by_page(plant: Database) -> None:
    ids, api, after, seen = stored(plant, 1, 2, 3), Api(plant), 0, []
    for _ in range(3):
        page = api.value(f"/estimates?after={after}&limit=2")
        seen += sorted({one["identification"] for one in page["estimates"]})
        after = page["after"]
    assert seen == ids
    assert not page["more"]
    assert after == ids[-1]
    new = stored(plant, 4)
    assert {one["identification"] for one in api.value(f"/estimates?after={after}")["estimates"]} == set(new)


def test_who_keeps_no_cursor_gets_the_newest(plant: Database) -> None:
    """Telegraf asks the same again and again: of many it would else be told the oldest only."""
    ids = stored(plant, 1, 2, 3, 4, 5)
    api = Api(plant)
    told = api.value("/estimates?newest=true&limit=2")
    assert sorted({one["identification"] for one in told["estimates"]}) == ids[-2:]
    assert (told["after"], told["more"]) == (ids[-1], True)
    assert {one["identification"] for one in api.value("/estimates?limit=2")["estimates"]} == set(ids[:2])
    assert api.value(f"/estimates?newest=true&after={ids[-1]}")["estimates"] == []


def test_every_format_says_the_same(plant: Database) -> None:
    (number,) = stored(plant, 1)
    api = Api(plant)
    rows = api.value("/estimates")["estimates"]
    (kxx,) = [one for one in rows if one["parameter"] == "bearing.B1.kxx"]
    assert kxx["lower"] < kxx["value"] < kxx["upper"]
    answer = api.get("/estimates?format=parquet")
    assert answer.headers[filed_module.NEXT] == str(number)
    table = read_parquet(io.BytesIO(answer.content)).read_all()
    assert table.num_rows == len(rows)
    assert api.get("/estimates?format=csv").text.count("\r\n") == len(rows) + 1
    lines = api.get("/estimates?format=influx").text.splitlines()
    (line,) = [one for one in lines if ",parameter=bearing.B1.kxx," in one]
    assert f"machine={KEY.machine}" in line
    assert f"value={kxx['value']!r}" in line
    assert line.endswith(f" {START + 10**9}")


def test_a_name_that_a_spreadsheet_would_compute_is_text_in_csv(plant: Database) -> None:
    """Names of machines are letters, digits, '_' and '-': the last may begin one."""
    formula = "-1-A2"
    with plant.transaction() as session:
        machines.create(session, machine(id=formula))
        row = store_identification(session, identification(), run_id=9, measured_at=START, machine_id=formula)
        row.computed_at -= filed_estimates.HELD_BACK_NS
    answer = Api(plant).get("/estimates?format=csv")
    told = [row["machine"] for row in csv.DictReader(io.StringIO(answer.text, newline=""))]
    assert set(told) == {f"'{formula}"}
    assert formula in {one["machine"] for one in Api(plant).value("/estimates")["estimates"]}


def test_what_is_too_new_or_too_old_waits_or_is_left_out(plant: Database) -> None:
    api = Api(plant)
    with plant.transaction() as session:
        store_identification(session, identification(), run_id=1, measured_at=START)
    assert api.value("/estimates") == {"after": 0, "more": False, "estimates": []}
    stored(plant, 2)
    assert api.value("/estimates?within_days=1")["estimates"]
    with plant.transaction() as session:
        for row in filed_estimates.filed(session, after=0, limit=10):
            row.computed_at -= 2 * filed_module.DAY_NS
    assert not api.value("/estimates?within_days=1")["estimates"]
    assert api.get("/estimates?limit=201").status_code == 422
    assert api.get("/estimates?format=parquet").status_code == 200


def test_a_trend_is_line_protocol_when_asked(plant: Database) -> None:
    (number,) = stored(plant, 1)
    told = Api(plant).get(f"/machines/{KEY.machine}/trends?parameter=bearing.B1.kxx&parameter=disc.D1.unbalance&format=influx")
    assert told.headers["content-type"].startswith("text/plain")
    lines = told.text.splitlines()
    assert len(lines) == 2
    assert all(f"identification={number}i" in one and one.startswith("rundown_trend,machine=") for one in lines)


def test_a_cached_trend_in_line_protocol_is_compressed_as_the_first_was(plant: Database) -> None:
    stored(plant, *range(1, 31))
    api = Api(plant)
    path = f"/machines/{KEY.machine}/trends?parameter=bearing.B1.kxx&format=influx"
    first, cached = (api.ask("GET", PREFIX + path, headers={"accept-encoding": "gzip"}) for _ in range(2))
    assert first.text == cached.text
    assert first.status_code == 200, first.text
    assert [one.headers.get("content-encoding") for one in (first, cached)] == ["gzip", "gzip"]


def frame(file: io.BytesIO) -> pandas.DataFrame:
    """Read Parquet as `pandas.read_parquet` does where pyarrow is installed, which the tests do without."""
    table = read_parquet(file).read_all()
    return pandas.DataFrame({name: table[name].to_pylist() for name in table.schema.names})


def test_the_notebook_lines_of_the_page_on_grafana_read_everything(plant: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    ids = stored(plant, 1, 2, 3)
    page = (ROOT / "docs" / "grafana.md").read_text(encoding="utf-8")
    (printed,) = re.findall(r"^```python\n(import io, httpx.*?)^```", page, re.MULTILINE | re.DOTALL)
    monkeypatch.setattr(httpx, "get", Api(plant).http.get)
    monkeypatch.setattr(pandas, "read_parquet", frame)
    known: dict[str, Any] = {}
    exec(printed, known)
    assert known["after"] == ids[-1]
    assert {"bearing.B1.kxx", "coupling.C1.kxx"} <= set(known["frame"]["parameter"])
    assert set(known["frame"]["identification"]) == set(ids)
