"""The address space in words, as docs/opcua-address-space.json holds it: every node of one machine, without values.

Of alignment, loads and what else follows from an identification it holds one each.

`python -m tests.service.opcua.address_space docs/opcua-address-space.json` writes it anew.
"""

import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from asyncua import ua

from estimator.updated_model.derived_quantities import Derived
from service.configuration.settings import Settings
from service.opcua.serving import OpcUaServing
from storage.database.engine import Database
from storage.findings import derived, identifications
from tests.plant import KEY, wait_until
from tests.ports import free_port
from tests.service.security.two_plants import fill

FILE = Path(__file__).parents[3] / "docs" / "opcua-address-space.json"


FOLLOWING = (
    Derived("coupling.C1.offset_vertical", "m", 1.2e-4, 1.0e-4, 1.4e-4),
    Derived("bearing.B1.load_vertical", "N", 800.0, 750.0, 850.0),
    Derived("critical_speed.1", "rad/s", 150.0, 149.0, 151.0),
)


def fill_store(database: Database) -> None:
    """Write a store with two plants, and what follows from the newest identification of the first."""
    harbour, _ = fill(database)
    with database.transaction() as session:
        derived.add(session, identifications.get(session, harbour.identification_id), FOLLOWING)


def text(serving: OpcUaServing) -> str:
    """Return the file's content for what a server shows of the first plant."""
    return json.dumps(_described(serving), indent=1, ensure_ascii=False) + "\n"


def _described(serving: OpcUaServing) -> dict[str, Any]:
    assert serving._server is not None
    core = serving._server._core
    nodes = {}
    for number in sorted(core.aspace.keys(), key=str):
        if number.NamespaceIndex != core.names.index or core.names.plant_of(number) not in (None, KEY.plant):
            continue
        one = core.aspace[number]
        found = {name: one.attributes[name].value.Value.Value for name in one.attributes if name in _TOLD}
        said: dict[str, Any] = {"class": ua.NodeClass(found[ua.AttributeIds.NodeClass]).name}
        types = [ref.NodeId for ref in one.references if ref.ReferenceTypeId.Identifier == ua.ObjectIds.HasTypeDefinition]
        said["type"] = ua.ObjectIdNames[types[0].Identifier]
        said["reference"] = next(
            ua.ObjectIdNames[ref.ReferenceTypeId.Identifier] for ref in one.references if not ref.IsForward
        )
        if ua.AttributeIds.DataType in found:
            said["data type"] = ua.ObjectIdNames[found[ua.AttributeIds.DataType].Identifier]
            said["history"] = bool(found[ua.AttributeIds.Historizing])
        elif found[ua.AttributeIds.EventNotifier]:
            said["events"] = True
        methods = [ref.BrowseName.Name for ref in one.references if ref.IsForward and ref.NodeClass == ua.NodeClass.Method]
        if methods:
            said["methods"] = sorted(methods)
        nodes[str(number.Identifier)] = said
    return {"namespace": "urn:rundown:machines", "nodes": dict(sorted(nodes.items()))}


_TOLD = (
    ua.AttributeIds.NodeClass,
    ua.AttributeIds.DataType,
    ua.AttributeIds.EventNotifier,
    ua.AttributeIds.Historizing,
)


def write(path: Path) -> None:
    """Write the file."""
    with tempfile.TemporaryDirectory() as folder:
        database = Database(f"sqlite:///{folder}/rundown.db")
        fill_store(database)
        endpoint = f"opc.tcp://127.0.0.1:{free_port()}"
        serving = OpcUaServing(database, Settings(opcua_listen=endpoint, opcua_allow_unencrypted=True))
        serving.start()
        try:
            wait_until(lambda: serving.ready)
            path.write_text(text(serving))
        finally:
            serving.stop()
            database.close()


if __name__ == "__main__":
    write(Path(sys.argv[1]))
