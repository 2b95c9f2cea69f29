"""The dashboard of machines: each of its queries is put to the service, and what it picks from the answers is there."""

import csv
import io
import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
import yaml
from grafana_foundation_sdk.models.dashboard import Dashboard

from estimator.updated_model.derived_quantities import Derived
from service.alerts import transitions as alerting
from service.alerts.transitions import AlertFinding
from storage.database.engine import Database
from storage.findings import derived
from tests.api_in_process import Api
from tests.paths import ROOT
from tests.plant import KEY, START, identification, store_identification

FILE = ROOT / "examples" / "monitoring" / "grafana-machines.json"
COMPOSE = ROOT / "deploy" / "compose"
DASHBOARD: dict[str, Any] = json.loads(FILE.read_text())


def queries() -> Iterator[tuple[str, dict[str, Any]]]:
    """Every query of the file, and where it stands."""
    for panel in DASHBOARD["panels"]:
        for target in panel["targets"]:
            yield panel["title"], target
    for variable in DASHBOARD["templating"]["list"]:
        if variable["type"] == "query":
            yield f"variable {variable['name']}", variable["query"]["infinityQuery"]
    for one in DASHBOARD["annotations"]["list"]:
        yield one["name"], one["target"]


@pytest.fixture
def api(plant: Database) -> Api:
    """A plant in which something was found."""
    with plant.transaction() as session:
        stored = store_identification(session, identification(), run_id=1, measured_at=START)
        number = stored.id
        force = Derived("coupling.C1.misalignment_force", "N", 120.0, 100.0, 140.0, None)
        derived.add(session, stored, [force])
        finding = AlertFinding({}, number, START)
        alerting.raise_alert(session, KEY.machine, rule="misalignment", element="coupling.C1", finding=finding)
    return Api(plant)


def substituted(url: str, values: dict[str, str]) -> str:
    """A URL as Grafana asks for it."""
    times = {"__from:date:iso": "2023-11-01T00:00:00.000Z", "__to:date:iso": "2023-12-01T00:00:00.000Z"}
    return re.sub(r"\$\{([\w:]+)\}", lambda found: (times | values)[found[1]], url)


def picked(row: Any, selector: str) -> Any:
    """Return what a selector takes from a row; raises KeyError where it is not there. A null on the way is a null."""
    for name in selector.split("."):
        if row is None:
            return None
        row = row[name]
    return row


def in_schema(api: Api, url: str, root: str) -> dict[str, Any]:
    """The schema of the rows that a query picks, for answers without any."""
    told = api.app.openapi()
    path = re.sub(r"\$\{\w+\}", "x", url.split("?")[0])
    (found,) = [one for one in told["paths"] if re.fullmatch(re.sub(r"\{\w+\}", "x", one), path)]
    schema = told["paths"][found]["get"]["responses"]["200"]["content"]["application/json"]["schema"]
    for name in [*filter(None, root.split(".")), None]:
        schema = resolved(told, schema)
        schema = schema["items"] if name is None else schema["properties"][name]
    return dict(resolved(told, schema))


def resolved(told: dict[str, Any], schema: dict[str, Any]) -> dict[str, Any]:
    """A schema instead of a reference to it, or to it or null."""
    for one in schema.get("anyOf", ()):
        if one.get("type") != "null":
            schema = one
    return told["components"]["schemas"][schema["$ref"].split("/")[-1]] if "$ref" in schema else schema


@pytest.mark.parametrize(("where", "query"), list(queries()), ids=lambda one: one if isinstance(one, str) else "")
def test_each_query_is_answered_with_what_it_picks(api: Api, where: str, query: dict[str, Any]) -> None:
    values = {"machine": KEY.machine, "identification": "1", "bearing": "bearing.B1.kxx", "coupling": "coupling.C1.kxx"}
    values["alignment"] = "coupling.C1.misalignment_force"
    answer = api.ask("GET", substituted(query["url"], values))
    assert answer.status_code == 200, f"{where}: {answer.text}"
    selectors = [column["selector"] for column in query["columns"]]
    if query["type"] == "csv":
        header = next(csv.reader(io.StringIO(answer.text)))
        assert set(selectors) <= set(header), where
        return
    rows = answer.json()
    for name in filter(None, query["root_selector"].split(".")):
        rows = rows[name]
    assert isinstance(rows, list), where
    for row in rows:
        for selector in selectors:
            picked(row, selector)
    if not rows:
        told = api.app.openapi()
        for selector in selectors:
            schema = in_schema(api, query["url"], query["root_selector"])
            for name in selector.split("."):
                schema = resolved(told, schema["properties"][name])


@pytest.mark.parametrize(
    ("panel", "parameter"),
    [("bearing", "bearing.B1.kxx"), ("coupling", "coupling.C1.kxx"), ("alignment", "coupling.C1.misalignment_force")],
)
def test_trends_have_points_and_their_intervals(api: Api, panel: str, parameter: str) -> None:
    (query,) = [target for where, target in queries() if where == f"${panel}"]
    told = api.ask("GET", substituted(query["url"], {"machine": KEY.machine, panel: parameter}))
    (row,) = csv.DictReader(io.StringIO(told.text))
    assert float(row["lower"]) < float(row["value"]) < float(row["upper"])


def test_names_of_parameters_are_those_that_the_variables_pick(api: Api) -> None:
    for variable in DASHBOARD["templating"]["list"]:
        if variable.get("regex"):
            query = variable["query"]["infinityQuery"]
            (column,) = query["columns"]
            found = api.value("/identifications/1")[query["root_selector"]]
            assert any(re.search(variable["regex"].strip("/"), one[column["selector"]]) for one in found), variable["name"]


def test_a_query_for_all_of_everything_is_bounded(api: Api) -> None:
    """A hundred parameters of one machine at a time, so many points of each; lists come in pages."""
    many = "&".join(f"parameter=bearing.B1.k{number}" for number in range(101))
    assert api.get(f"/machines/{KEY.machine}/trends?{many}").status_code == 422
    assert api.get(f"/machines/{KEY.machine}/trends?parameter=bearing.B1.kxx&max_points=20001").status_code == 422
    assert api.get(f"/machines/{KEY.machine}/samples?limit=10001").status_code == 422
    for where, query in queries():
        limited = re.search(r"[?&](limit|max_points)=(\d+)", query["url"])
        one_thing = query["url"].endswith(("/alignment", "/vibration", "/identifications/${identification}"))
        assert one_thing or (limited is not None and int(limited[2]) <= 1000), where


COLUMN_TYPES = {"string", "number", "timestamp", "timestamp_epoch", "timestamp_epoch_s"}
FORMATS = {"table", "timeseries", "dataframe", "as-is", "node-graph-nodes", "node-graph-edges"}
QUERY_FIELDS = {"refId", "datasource", "type", "source", "parser", "format", "url", "url_options", "root_selector", "columns"}
OPTIONAL_FIELDS = {"filters", "filterExpression", "summarizeExpression", "summarizeBy", "computed_columns"}


@pytest.mark.parametrize(("where", "query"), list(queries()), ids=lambda one: one if isinstance(one, str) else "")
def test_each_query_has_the_fields_that_the_data_source_reads(where: str, query: dict[str, Any]) -> None:
    """As its types say: grafana/grafana-infinity-datasource, src/types/query.types.ts and variables.types.ts (Apache-2.0)."""
    assert set(query) - OPTIONAL_FIELDS == QUERY_FIELDS, where
    assert query["type"] in {"json", "csv"}
    assert (query["source"], query["parser"]) == ("url", "backend"), "only the backend's parser works for alerting and sharing"
    assert query["format"] in FORMATS
    assert query["url_options"]["method"] == "GET"
    assert set(query["url_options"]) <= {"method", "params", "headers", "data", "body_type", "body_content_type"}
    for column in query["columns"]:
        assert set(column) <= {"selector", "text", "type", "timestampFormat"}, where
        assert column["type"] in COLUMN_TYPES
    if query["format"] == "timeseries":
        assert {"timestamp", "number"} <= {column["type"] for column in query["columns"]}, "a series needs a time and a number"


def test_each_variable_asks_as_the_data_source_reads_it() -> None:
    for variable in DASHBOARD["templating"]["list"]:
        if variable["type"] == "query":
            assert set(variable["query"]) == {"queryType", "refId", "query", "infinityQuery"}
            assert variable["query"]["queryType"] == "infinity"


def test_an_import_finds_all_that_the_file_asks_for() -> None:
    """As Grafana imports a file: it names the plugins it needs, asks for nothing, and its data source is a variable."""
    panels, variables = DASHBOARD["panels"], {one["name"] for one in DASHBOARD["templating"]["list"]}
    needed = {(one["type"], one["id"]) for one in DASHBOARD["__requires"]}
    used = {("datasource", query["datasource"]["type"]) for _, query in queries()} | {("panel", one["type"]) for one in panels}
    assert needed == used | {("grafana", "grafana")}
    assert "__inputs" not in DASHBOARD
    assert "id" not in DASHBOARD, "a number would be another dashboard's there"
    assert DASHBOARD["schemaVersion"] >= 39, "of Grafana 11; newer ones bring it up to theirs"
    assert {query["datasource"]["uid"] for _, query in queries()} == {"${datasource}"}
    built_in = {"__from", "__to"}
    asked = {one.split(":")[0] for one in re.findall(r"\$\{([\w:]+)\}", json.dumps(DASHBOARD))}
    assert asked - built_in <= variables
    assert len({one["id"] for one in panels}) == len(panels)
    cells = [
        (one["gridPos"]["x"] + column, one["gridPos"]["y"] + line)
        for one in panels
        for column in range(one["gridPos"]["w"])
        for line in range(one["gridPos"]["h"])
    ]
    assert len(set(cells)) == len(cells), "panels do not cover each other"
    assert max(column for column, _ in cells) < 24


def test_grafana_knows_the_dashboard_and_the_service() -> None:
    found = Dashboard.from_json(DASHBOARD)
    assert [one.title for one in found.panels or []] == [one["title"] for one in DASHBOARD["panels"]]
    provisioned = yaml.safe_load((COMPOSE / "grafana/provisioning/datasources/rundown.yml").read_text())["datasources"]
    kinds = {query["datasource"]["type"] for _, query in queries()}
    assert {one["type"] for one in provisioned} == kinds
    grafana = yaml.safe_load((COMPOSE / "compose.yaml").read_text())["services"]["grafana"]
    assert grafana["environment"]["GF_INSTALL_PLUGINS"] in kinds
    assert any(FILE.name in volume for volume in grafana["volumes"])
    for one in provisioned:
        (secret,) = re.findall(r"/run/secrets/(\w+)", one["secureJsonData"]["bearerToken"])
        assert secret in grafana["secrets"]
