"""Trends through the API: columns, time ranges, thinning out that keeps the extremes, other formats, nothing out of date."""

import csv
import io
import itertools
import json
import math
from collections.abc import Sequence
from datetime import datetime, timedelta
from typing import Any

import numpy as np
import pytest
from arro3.core import Table
from arro3.io import read_parquet
from hypothesis import given
from hypothesis import strategies as st

from service.api.conventions.formats import CSV, JSON, PARQUET, parquet_bytes
from service.api.trends.downsampling import min_max
from service.client import Rundown
from service.monitoring.parameter_catalogue import MAXIMUM_REVISIONS
from storage.database.engine import Database
from storage.encoding.source_key import SourceKey
from storage.findings import jobs
from storage.machines import baselines, machines, timeline
from storage.measurements import runs
from storage.measurements import samples as sample_store
from tests.api_in_process import Api, fields, problem
from tests.plant import KEY, SECOND, START, document, few_examples, identification, machine, samples, store_identification

PATH = f"/machines/{KEY.machine}/trends"
PARTS = ("real", "imaginary", "angle_deg", "angle_half_width_deg")
"""Of an unbalance."""
COLUMNS = ("measured_at", "computed_at", "value", "standard_error", "lower", "upper", "quality", "run_kind", "identification")
HOUR = 3600 * SECOND


def at(hours: float) -> str:
    """A time after the first identification."""
    return (datetime.fromisoformat("2023-11-14T22:13:20+00:00") + timedelta(hours=hours)).isoformat()


def store(database: Database, factors: Sequence[float], **changes: Any) -> None:
    with database.transaction() as session:
        for number, factor in enumerate(factors):
            outcome = identification({"coupling.C1.kxx": factor}, **changes)
            store_identification(session, outcome, run_id=100 + number, measured_at=START + number * HOUR)


@pytest.fixture
def api(plant: Database) -> Api:
    """An API over three identifications, of which the second was not accepted, and one of several runs together."""
    with plant.transaction() as session:
        for number, (factor, accepted) in enumerate([(1.0, True), (1.1, False), (1.2, True)]):
            outcome = identification({"coupling.C1.kxx": factor}, unknown=["bearing.B1.kxy"], accepted=accepted)
            store_identification(session, outcome, run_id=100 + number, measured_at=START + number * HOUR)
        gathered = identification({"coupling.C1.kxx": 1.5})
        store_identification(session, gathered, run_id=200, scope=jobs.GATHERED, run_kind="gathered")
    return Api(plant)


def trend(api: Api, *names: str, **asked: Any) -> list[dict[str, Any]]:
    body = api.value(PATH, parameter=list(names), **asked)
    assert body["machine"] == KEY.machine
    series: list[dict[str, Any]] = body["series"]
    for one in series:
        assert len({len(one[column]) for column in COLUMNS}) == 1
    return series


def test_the_trend_of_a_parameter(api: Api) -> None:
    (one,) = trend(api, "coupling.C1.kxx")
    assert (one["parameter"], one["unit"]) == ("coupling.C1.kxx", "N/m")
    assert one["value"] == pytest.approx([2.0e6, 2.2e6, 2.4e6])
    assert one["lower"] == pytest.approx([0.98 * value for value in one["value"]])
    assert one["standard_error"] == pytest.approx([2e4] * 3)
    assert one["quality"] == ["accepted", "not_accepted", "accepted"]
    assert [datetime.fromisoformat(moment).isoformat() for moment in one["measured_at"]] == [at(hours) for hours in range(3)]
    assert all(moment.endswith("Z") for moment in one["measured_at"] + one["computed_at"])
    assert one["down_sampling"] == {"method": "none", "points": 3}
    assert [one[part] for part in PARTS] == [None] * 4


@pytest.mark.parametrize(
    ("first", "last", "values"),
    [
        (0.0, 2.0, [2.0e6, 2.2e6, 2.4e6]),
        (0.5, 1.5, [2.2e6]),
        (1.0, 1.0, [2.2e6]),
        (0.5, None, [2.2e6, 2.4e6]),
        (None, 0.5, [2.0e6]),
        (2.5, None, []),
    ],
)
def test_over_a_time_range_to_which_both_ends_belong(
    api: Api, first: float | None, last: float | None, values: list[float]
) -> None:
    asked = {name: at(hours) for name, hours in {"from": first, "to": last}.items() if hours is not None}
    (one,) = trend(api, "coupling.C1.kxx", **asked)
    assert one["value"] == pytest.approx(values)
    assert one["down_sampling"]["points"] == len(values)


def test_several_parameters_come_as_asked_for_each_once(api: Api) -> None:
    names = ["disc.D1.unbalance", "bearing.B1.kxy", "critical_speed.2", "bearing.B1.kxx"]
    found = trend(api, *names, names[0])
    assert [one["parameter"] for one in found] == names
    assert found[0]["imaginary"] == [-5e-4] * 3
    assert found[0]["real"] == [1e-3] * 3
    assert found[0]["value"] == pytest.approx([math.hypot(1e-3, 5e-4)] * 3)
    assert found[0]["standard_error"] == [None] * 3
    assert found[0]["angle_deg"] == pytest.approx([360 - math.degrees(math.atan(0.5))] * 3)
    surely = [
        math.degrees(math.asin(high / size - 1)) for size, high in zip(found[0]["value"], found[0]["upper"], strict=True)
    ]
    assert found[0]["angle_half_width_deg"] == pytest.approx(surely)
    assert found[1]["value"] == [None] * 3
    assert found[1]["quality"] == ["not_estimable", "not_accepted", "not_estimable"]
    assert (found[2]["unit"], found[2]["value"]) == ("rad/s", [])


def test_of_gathered_runs_they_are_their_own(api: Api) -> None:
    (one,) = trend(api, "coupling.C1.kxx", scope="gathered")
    assert one["value"] == pytest.approx([3.0e6])
    assert one["run_kind"] == ["gathered"]


def test_what_is_stored_later_shows_at_once(api: Api) -> None:
    assert len(trend(api, "coupling.C1.kxx")[0]["value"]) == 3
    with api.database.transaction() as session:
        store_identification(session, identification(), run_id=300, measured_at=START + 9 * HOUR)
    assert len(trend(api, "coupling.C1.kxx")[0]["value"]) == 4
    with api.database.transaction() as session:
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-down", direction=1, time_first=START)
        store_identification(session, identification(), run_id=run.id, measured_at=START + 10 * HOUR)
    assert len(trend(api, "coupling.C1.kxx")[0]["value"]) == 5
    with api.database.transaction() as session:  # late samples join the run to another
        runs.close(runs.get(session, run.id), samples=samples(), state=runs.DISCARDED, reason="joined")
    assert len(trend(api, "coupling.C1.kxx")[0]["value"]) == 4


def test_a_long_series_is_thinned_out_and_keeps_its_extremes(plant: Database) -> None:
    factors = [1.0 + 0.001 * math.sin(number) for number in range(60)]
    factors[17], factors[40] = 1.9, 0.4
    store(plant, factors)
    (one,) = trend(Api(plant), "coupling.C1.kxx", max_points=12)
    assert one["down_sampling"] == {"method": "min-max-per-bucket", "points": 60}
    assert len(one["value"]) <= 12
    assert (max(one["value"]), min(one["value"])) == pytest.approx((3.8e6, 0.8e6))
    assert one["measured_at"] == sorted(one["measured_at"])
    whole = trend(Api(plant), "coupling.C1.kxx")[0]
    rows = set(zip(*(whole[column] for column in COLUMNS), strict=True))
    assert set(zip(*(one[column] for column in COLUMNS), strict=True)) <= rows


@given(
    values=st.lists(st.one_of(st.floats(-1e3, 1e3), st.just(math.nan)), max_size=200),
    most=st.integers(4, 50),
    seed=st.integers(0, 2**32 - 1),
)
@few_examples
def test_thinning_out_keeps_ends_and_extremes_and_never_exceeds(values: list[float], most: int, seed: int) -> None:
    value = np.array(values)
    time = np.sort(np.random.default_rng(seed).integers(0, 10**18, len(values)))
    chosen = min_max(time, value, np.zeros(len(value), np.int64), most=most)
    kept = value[chosen.index]
    assert chosen.points == len(values)
    assert len(chosen.index) <= max(most, 0)
    assert np.all(np.diff(chosen.index) > 0)
    if len(values) <= most:
        assert (chosen.method, len(chosen.index)) == ("none", len(values))
        return
    assert (chosen.index[0], chosen.index[-1]) == (0, len(values) - 1)
    if np.isfinite(value).any():
        assert (np.nanmin(kept), np.nanmax(kept)) == (np.nanmin(value), np.nanmax(value))


def test_a_stretch_without_values_is_still_seen() -> None:
    value = np.array([1.0] * 50 + [math.nan] * 50 + [1.0] * 50)
    chosen = min_max(np.arange(150) * SECOND, value, np.zeros(150, np.int64), most=20)
    assert np.isnan(value[chosen.index]).any()


def test_each_baseline_has_its_band(plant: Database) -> None:
    factors = [1.0, 1.01, 0.99, 1.0, 1.0, 1.3, 1.3, 1.31, 1.29, 1.3, 1.3, 1.3]
    store(plant, factors)
    with plant.transaction() as session:
        baselines.begin(session, KEY.machine, since=START + 6 * HOUR, identification_ids=None, reason="why", by="anna")
    (one,) = trend(Api(plant), "coupling.C1.kxx")
    first, second = one["baselines"]
    assert (first["since"], first["until"]) == (one["measured_at"][0], one["measured_at"][6])
    assert (second["since"], second["until"]) == (one["measured_at"][6], None)
    assert [first["identifications"], second["identifications"]] == [[1, 2, 3, 4, 5], [7, 8, 9, 10, 11]]
    assert first["centre"] == pytest.approx(2e6, rel=1e-3)
    assert second["centre"] == pytest.approx(2.6e6, rel=1e-3)
    assert first["lower"] < first["centre"] < first["upper"] < 1.1 * first["centre"]
    unbalance = trend(Api(plant), "disc.D1.unbalance")[0]
    assert unbalance["baselines"][0]["centre"] == pytest.approx(unbalance["value"][0])


def test_a_baseline_that_is_not_complete_has_no_band(plant: Database) -> None:
    store(plant, [1.0, 1.0, 1.0, 1.0])
    with plant.transaction() as session:
        store_identification(session, identification(), run_id=200, scope=jobs.GATHERED, run_kind="gathered")
    api = Api(plant)
    assert trend(api, "coupling.C1.kxx")[0]["baselines"] == []
    assert trend(api, "coupling.C1.kxx", scope="gathered")[0]["baselines"] == []


@pytest.mark.parametrize(
    ("asked", "media"),
    [
        ({"params": {"format": "csv"}}, CSV),
        ({"params": {"format": "json"}, "headers": {"accept": "text/csv"}}, JSON),
        ({"headers": {"accept": "text/csv"}}, CSV),
        ({"headers": {"accept": PARQUET}}, PARQUET),
        ({"headers": {"accept": "application/json;q=0.1, text/csv;q=0.5"}}, CSV),
        ({"headers": {"accept": "text/html,application/xml;q=0.9,*/*;q=0.8"}}, JSON),
        ({"headers": {"accept": "text/*"}}, CSV),
        ({"headers": {}}, JSON),
    ],
)
def test_the_format_is_chosen_by_parameter_or_accept(api: Api, asked: dict[str, Any], media: str) -> None:
    asked = asked | {"params": {"parameter": "coupling.C1.kxx"} | asked.get("params", {})}
    answer = api.ask("GET", f"/api/v1{PATH}", **asked)
    assert answer.status_code == 200
    assert answer.headers["content-type"].split(";")[0] == media
    assert answer.headers["vary"] == "Accept, Accept-Encoding"


def test_another_format_is_refused(api: Api) -> None:
    answer = api.ask("GET", f"/api/v1{PATH}?parameter=bearing.B1.kxx", headers={"accept": "application/pdf"})
    assert "text/csv" in problem(answer, 406)["detail"]
    assert fields(api.get(PATH, parameter="bearing.B1.kxx", format="xlsx")) == ["query.format"]


def test_csv_and_parquet_hold_what_json_holds(api: Api) -> None:
    names = ["coupling.C1.kxx", "disc.D1.unbalance", "bearing.B1.kxy"]
    whole = trend(api, *names)
    expected = [
        {"parameter": one["parameter"], "unit": one["unit"]}
        | {column: one[column][number] for column in COLUMNS}
        | {part: one[part][number] if one[part] else None for part in PARTS}
        | dict.fromkeys(("baseline_centre", "baseline_lower", "baseline_upper"))
        | {"down_sampling": "none", "points": 3}
        for one in whole
        for number in range(3)
    ]
    text = api.get(PATH, parameter=names, format="csv").text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert rows == [{name: "" if value is None else str(value) for name, value in row.items()} for row in expected]
    table = Table(read_parquet(io.BytesIO(api.get(PATH, parameter=names, format="parquet").content)))
    columns = {name: table[name].to_pylist() for name in table.column_names}
    assert list(columns) == list(expected[0])
    for name, column in columns.items():
        if name.endswith("_at"):
            assert column == [datetime.fromisoformat(row[name]) for row in expected]
        else:
            assert column == [row[name] for row in expected]


def test_each_row_of_a_table_says_how_it_was_thinned_out_and_what_it_is_compared_with(plant: Database) -> None:
    store(plant, [1.0 + 0.001 * math.sin(number) for number in range(60)])
    with plant.transaction() as session:
        baselines.begin(session, KEY.machine, since=START + 30 * HOUR, identification_ids=None, reason="why", by="anna")
        odd = identification({"coupling.C1.kxx": 1.0})
        store_identification(session, odd, run_id=300, run_kind="run-up", measured_at=START + 45 * HOUR)
    one = trend(Api(plant), "coupling.C1.kxx", max_points=12)[0]
    text = Api(plant).get(PATH, parameter="coupling.C1.kxx", max_points=12, format="csv").text
    rows = list(csv.DictReader(io.StringIO(text)))
    assert [float(row["value"]) for row in rows] == one["value"]
    assert {(row["down_sampling"], row["points"]) for row in rows} == {("min-max-per-bucket", "61")}
    first, second = one["baselines"]
    for row in rows:
        band = second if row["measured_at"] >= second["since"] else first
        expected = [str(band[name]) for name in ("centre", "lower", "upper")] if row["run_kind"] != "run-up" else [""] * 3
        assert [row[f"baseline_{name}"] for name in ("centre", "lower", "upper")] == expected


def test_times_in_parquet_are_exact_to_the_microsecond() -> None:
    texts = [f"2026-11-21T12:34:56.{number:06d}Z" for number in range(0, 1_000_000, 997)]
    table = Table(read_parquet(io.BytesIO(parquet_bytes({"at": texts}, times=("at",)))))
    assert table["at"].to_pylist() == [datetime.fromisoformat(text) for text in texts]


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({}, "query.parameter"),
        ({"parameter": "bearing.B1.kxx", "scope": "all"}, "query.scope"),
        ({"parameter": "bearing.B1.kxx", "max_points": 9}, "query.max_points"),
        ({"parameter": "bearing.B1.kxx", "max_points": 20_001}, "query.max_points"),
        ({"parameter": ["bearing.B1.kxx"] * 101}, "query.parameter"),
        ({"parameter": "bearing.B1.kxx", "from": "yesterday"}, "query.from"),
    ],
)
def test_a_wrong_question_is_refused_by_field(api: Api, asked: dict[str, Any], field: str) -> None:
    assert fields(api.get(PATH, **asked)) == [field]


def test_of_an_unknown_machine_there_are_none(api: Api) -> None:
    problem(api.get("/machines/nobody/trends", parameter="bearing.B1.kxx"), 404)


def test_units_of_vibration_change_nothing_in_trends(plant: Database) -> None:
    api, asked = Api(plant), {"parameter": "coupling.C1.kxx"}
    plain = api.value("/machines/pump-7/trends", **asked)
    assert api.value("/machines/pump-7/trends", **asked, units="um_pp,deg_lag") == plain
    assert fields(api.get("/machines/pump-7/trends", **asked, units="um_pp,furlong")) == ["query.units"]


def test_what_is_no_name_of_a_parameter_is_refused(plant: Database) -> None:
    assert fields(Api(plant).get("/machines/pump-7/trends", parameter="nope")) == ["query.parameter[0]"]


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("bearing.B4.cyy", "N s/m"),
        ("coupling.C1.k_phix", "N m/rad"),
        ("disc.D2.unbalance", "kg m"),
        ("critical_speed.1", "rad/s"),
        ("splitting.1-2", "1"),
        ("coupling.C1.misalignment_moment", "N m"),
        ("probe.B2X.amplification_factor.12", "1"),
    ],
)
def test_what_the_machine_has_and_was_never_identified_is_empty_and_in_its_unit(plant: Database, name: str, unit: str) -> None:
    for scope in ("run", "gathered"):
        (one,) = trend(Api(plant), name, scope=scope)
        assert (one["unit"], one["value"], one["baselines"]) == (unit, [], [])
    assert Api(plant).get(PATH, parameter=name, format="csv").status_code == 200


def test_it_is_empty_in_the_units_asked_for(plant: Database) -> None:
    (one,) = trend(Api(plant), "critical_speed.1", units="rpm")
    assert one["unit"] == "rpm"


@pytest.mark.parametrize(
    ("name", "there"),
    [
        ("bearing.NOPE.k_yy", "it has bearing.B1, bearing.B2, bearing.B3, bearing.B4, coupling.C1, disc.D1, disc.D2, "),
        ("bearing.B1.k_yy", "bearing.B1 has bearing.B1.kxx, bearing.B1.kxy, "),
        ("bearing.B1.kxx@1500rpm", "bearing.B1 has bearing.B1.kxx, "),
        ("critical_speed.0", "critical_speed has critical_speed.1 …"),
        ("critical_speed.N", "critical_speed has critical_speed.1 …"),
        ("splitting.2-1", "splitting has splitting.1-2 …"),
        ("splitting.M-N", "splitting has splitting.1-2 …"),
        ("probe.B2X.amplification_factor.N", "probe.B2X has probe.B2X.amplification_factor.1 …, "),
        ("probe.B9X.second_over_first", "probe.B2X"),
        ("probe.B2X.gain", "probe.B2X has probe.B2X.amplification_factor.1 …, probe.B2X.second_over_first"),
        ("nothing.there", "it has bearing.B1, "),
    ],
)
def test_what_the_machine_cannot_have_is_not_found(api: Api, name: str, there: str) -> None:
    for asked in (name, ["coupling.C1.kxx", name]):
        detail = problem(api.get(PATH, parameter=asked), 404)["detail"]
        assert detail.startswith(f"no parameter {name} of machine '{KEY.machine}': ")
        assert there in detail


def test_what_only_an_earlier_revision_had_is_still_there(plant: Database) -> None:
    with plant.transaction() as session:
        discs = document()["discs"][:1]
        machines.revise(session, machine(discs=discs))
    (one,) = trend(Api(plant), "disc.D2.unbalance")
    assert (one["unit"], one["value"]) == ("kg m", [])
    assert "disc.D2" not in problem(Api(plant).get(PATH, parameter="disc.D3.unbalance"), 404)["detail"].partition(": ")[2]


def test_of_many_revisions_the_newest_are_looked_at(plant: Database) -> None:
    with plant.transaction() as session:
        for number in range(MAXIMUM_REVISIONS - 1):
            machines.revise(session, machine(discs=document()["discs"][:1], name=f"Pump {number}"))
    assert trend(Api(plant), "disc.D2.unbalance")[0]["value"] == []
    with plant.transaction() as session:
        machines.revise(session, machine(discs=document()["discs"][:1]))
    problem(Api(plant).get(PATH, parameter="disc.D2.unbalance"), 404)


def test_an_unbalance_that_was_not_estimable_once_has_no_components_there(plant: Database) -> None:
    store(plant, [1.0])
    store_unknown = identification(unknown=["disc.D1.unbalance"])
    with plant.transaction() as session:
        store_identification(session, store_unknown, run_id=200, measured_at=START + HOUR)
    api = Api(plant)
    (series,) = trend(api, "disc.D1.unbalance")
    for part in ("real", "imaginary", "angle_deg", "angle_half_width_deg"):
        assert [value is None for value in series[part]] == [False, True], part
    with Rundown(http=api.http) as client:
        assert client.trends(KEY.machine, "disc.D1.unbalance").series[0].real == series["real"]


@pytest.mark.parametrize("path", ["trends", "identifications", "runs", "samples", "timeline"])
def test_a_time_that_was_answered_belongs_to_the_range_that_it_ends(plant: Database, path: str) -> None:
    """The store counts nanoseconds, answers have microseconds."""
    odd = START + 123_456_789
    with plant.transaction() as session:
        run = runs.open_run(session, KEY.machine, revision=1, kind="run-up", direction=1, time_first=odd)
        store_identification(session, identification(), run_id=run.id, measured_at=odd)
        timeline.add(session, KEY.machine, at=odd, kind="note", text="odd", by="anna")
        one = samples(2, start=odd)
        sample_store.add_block(
            session, SourceKey(KEY.machine, "monitor", 1), revision=1, first_sequence=0, samples=one, received_at=odd
        )
    api = Api(plant)
    time = "2023-11-14T22:13:20.123456Z"
    asked = {"parameter": "coupling.C1.kxx"} if path == "trends" else {}
    found = api.value(f"/machines/{KEY.machine}/{path}", **asked, **{"from": time, "to": time})
    assert time in json.dumps(found)


@given(
    points=st.lists(
        st.tuples(st.one_of(st.floats(-1e3, 1e3), st.just(math.nan)), st.booleans(), st.booleans()), min_size=1, max_size=200
    ),
    most=st.integers(10, 60),
    seed=st.integers(0, 2**32 - 1),
)
@few_examples
def test_thinning_out_keeps_the_extremes_of_each_kind_of_run_among_the_accepted(
    points: list[tuple[float, bool, bool]], most: int, seed: int
) -> None:
    value, up, accepted = (np.array(column) for column in zip(*points, strict=True))
    time = np.sort(np.random.default_rng(seed).integers(0, 10**18, len(points)))
    kind = 2 * up.astype(np.int64) + accepted
    chosen = min_max(time, value, kind, most=most)
    assert len(chosen.index) <= most
    if len(points) <= most:
        return
    buckets = (most - 2) // (2 * len(np.unique(kind)))
    ends = np.linspace(float(time[0]), float(time[-1]), buckets + 1)
    bucket = np.clip(np.searchsorted(ends, time.astype(np.float64), "right") - 1, 0, buckets - 1)
    for one, of_kind in itertools.product(range(buckets), np.unique(kind)):
        there = value[(bucket == one) & (kind == of_kind)]
        stay = value[np.intersect1d(chosen.index, np.flatnonzero((bucket == one) & (kind == of_kind)))]
        assert len(stay) > 0 or len(there) == 0
        if np.isfinite(there).any():
            assert (np.nanmin(stay), np.nanmax(stay)) == (np.nanmin(there), np.nanmax(there))


def test_where_there_is_no_room_for_each_kind_all_are_thinned_out_together(plant: Database) -> None:
    """Once its runs were gathered in another way, a machine has three kinds, accepted and not."""
    kinds = ("run-up", "run-down", "rolling")
    with plant.transaction() as session:
        for number in range(60):
            outcome = identification({"coupling.C1.kxx": 1.0 + 0.01 * number}, accepted=number % 2 == 0)
            store_identification(
                session, outcome, run_id=number, run_kind=kinds[number % 3], measured_at=START + number * HOUR
            )
    (one,) = trend(Api(plant), "coupling.C1.kxx", max_points=10)
    assert len(one["value"]) <= 10
    assert max(one["value"]) / min(one["value"]) == pytest.approx(1.59)
    assert one["down_sampling"] == {"method": "min-max-per-bucket", "points": 60}


@pytest.mark.parametrize("most", [10, 30])
def test_a_fit_that_failed_takes_the_place_of_no_accepted_value(plant: Database, most: int) -> None:
    with plant.transaction() as session:
        for number in range(80):
            bad, kind = number % 4 == 1, "run-up" if number % 2 else "run-down"
            factor = {"run-up": 1.5, "run-down": 0.8}[kind] + 0.001 * math.sin(number)
            outcome = identification({"coupling.C1.kxx": 9.0 if bad else factor}, accepted=not bad)
            store_identification(session, outcome, run_id=100 + number, run_kind=kind, measured_at=START + number * HOUR)
    (whole,), (thin,) = (trend(Api(plant), "coupling.C1.kxx", max_points=points) for points in (5000, most))
    assert thin["down_sampling"] == {"method": "min-max-per-bucket", "points": 80}
    assert len(thin["value"]) <= most
    for kind in ("run-up", "run-down"):
        expected, found = (accepted(one, kind) for one in (whole, thin))
        assert (min(found), max(found)) == (min(expected), max(expected))


def accepted(series: dict[str, Any], kind: str) -> list[float]:
    """Return the accepted values of a kind of run."""
    rows = zip(series["value"], series["run_kind"], series["quality"], strict=True)
    return [value for value, of_kind, quality in rows if of_kind == kind and quality == "accepted"]
