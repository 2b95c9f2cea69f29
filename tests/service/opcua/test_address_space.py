"""The address space is the one that docs/opcua-address-space.json tells clients of."""

import csv
import json
import subprocess
from collections.abc import Iterator

import pytest

from service.configuration.settings import Settings
from service.doctor.opcua_greeting import greet
from service.opcua.engineering_units import CODES, engineering_unit
from service.opcua.serving import OPENING, OpcUaServing
from storage.database.engine import Database
from tests.paths import ROOT
from tests.plant import wait_until
from tests.ports import free_port
from tests.service.opcua.address_space import FILE, fill_store, text
from tests.service.opcua.second_stack import FOLDER, require_node


@pytest.fixture
def serving(database: Database) -> Iterator[OpcUaServing]:
    fill_store(database)
    endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
    one = OpcUaServing(database, Settings(opcua_listen=endpoint, opcua_allow_unencrypted=True))
    one.start()
    wait_until(lambda: one.trouble != OPENING)
    yield one
    one.stop()


def test_the_file_holds_every_node_and_the_doctor_is_greeted_back(serving: OpcUaServing) -> None:
    assert text(serving) == FILE.read_text(), "python -m tests.service.opcua.address_space docs/opcua-address-space.json"
    _, port = serving._settings.opcua_address
    greet("127.0.0.1", port, within_s=5.0)


def test_what_does_not_answer_as_opc_ua_is_said() -> None:
    with pytest.raises(OSError, match="refused"):
        greet("127.0.0.1", free_port(), within_s=1.0)


@pytest.mark.parametrize("unit", [*CODES, "N/rad", "N m s/rad"])
def test_units_have_their_text_and_a_number_where_there_is_a_code(unit: str) -> None:
    found = engineering_unit(unit)
    assert found.DisplayName.Text == ("" if unit == "1" else unit)
    assert (found.UnitId > 0) is (unit in CODES)


UNECE = ROOT / "tests" / "data" / "unece-units.csv"
NODE_OPCUA_UNITS = {
    "kg": "kilogram",
    "m": "metre",
    "N": "newton",
    "deg": "degree",
    "r/min": "revolutions_per_minute",
}
"""Units of which the second stack has a table."""


def test_common_codes_are_those_of_the_recommendation() -> None:
    """The table is another implementation's; its source stands in tests/data/README.md."""
    with UNECE.open(encoding="utf-8", newline="") as file:
        table = {row["unit"]: row for row in csv.DictReader(file)}
    assert {unit: row["common code"] for unit, row in table.items()} == CODES
    assert {unit: engineering_unit(unit).UnitId for unit in table} == {unit: int(row["id"]) for unit, row in table.items()}


def test_common_codes_are_the_second_stacks() -> None:
    require_node()
    names = json.dumps(NODE_OPCUA_UNITS)
    script = (
        f"const d = require('node-opcua-data-access'); const names = {names}; const codes = {json.dumps(CODES)};"
        "const table = Object.fromEntries(Object.entries(names).map(([unit, name]) => [unit, d.standardUnits[name].unitId]));"
        "const rule = Object.fromEntries(Object.entries(codes).map(([unit, code]) => [unit, d.commonCodeToUInt(code)]));"
        "console.log(JSON.stringify({ table, rule }))"
    )
    done = subprocess.run(["node", "-e", script], cwd=FOLDER, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    ours = {unit: engineering_unit(unit).UnitId for unit in CODES}
    assert found["rule"] == ours
    assert found["table"] == {unit: ours[unit] for unit in NODE_OPCUA_UNITS}
