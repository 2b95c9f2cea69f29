"""Sparkplug B: payloads as another implementation writes them, gaps by the node's count, names by births."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory  # type: ignore[import-untyped]
from hypothesis import given
from hypothesis import strategies as st

from estimator.errors import Invalid
from estimator.machine.document import Machine, parse_machine
from service.mqtt.mapped_machines import MappedMachines
from service.mqtt.sparkplug_nodes import SOURCE, SparkplugNodes
from service.mqtt.sparkplug_payload import REBIRTH, decoded, rebirth
from service.wire import Rejected
from storage.database.engine import Database
from storage.machines import machines
from tests.mosquitto import Mosquitto
from tests.plant import KEY, START, document, few_examples, wait_until
from tests.service.ingest.plant_network import rejected, rows
from tests.service.mqtt.conftest import Taking

TYPES = descriptor_pb2.FieldDescriptorProto
METRIC = (
    ("name", 1, TYPES.TYPE_STRING),
    ("alias", 2, TYPES.TYPE_UINT64),
    ("timestamp", 3, TYPES.TYPE_UINT64),
    ("datatype", 4, TYPES.TYPE_UINT32),
    ("is_historical", 5, TYPES.TYPE_BOOL),
    ("is_null", 7, TYPES.TYPE_BOOL),
    ("int_value", 10, TYPES.TYPE_UINT32),
    ("long_value", 11, TYPES.TYPE_UINT64),
    ("float_value", 12, TYPES.TYPE_FLOAT),
    ("double_value", 13, TYPES.TYPE_DOUBLE),
    ("boolean_value", 14, TYPES.TYPE_BOOL),
    ("string_value", 15, TYPES.TYPE_STRING),
)
"""Fields of the public sparkplug_b.proto (Eclipse Tahu, EPL-2.0): names, numbers and types, as far as they are needed here."""


def _payload_class() -> Any:
    file = descriptor_pb2.FileDescriptorProto(name="sparkplug_b.proto", package="sparkplug", syntax="proto2")
    payload = file.message_type.add(name="Payload")
    metric = payload.nested_type.add(name="Metric")
    for name, number, kind in METRIC:
        metric.field.add(name=name, number=number, type=kind, label=TYPES.LABEL_OPTIONAL)
    payload.field.add(name="timestamp", number=1, type=TYPES.TYPE_UINT64, label=TYPES.LABEL_OPTIONAL)
    payload.field.add(
        name="metrics", number=2, type=TYPES.TYPE_MESSAGE, type_name=".sparkplug.Payload.Metric", label=TYPES.LABEL_REPEATED
    )
    payload.field.add(name="seq", number=3, type=TYPES.TYPE_UINT64, label=TYPES.LABEL_OPTIONAL)
    pool = descriptor_pool.DescriptorPool()
    pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName("sparkplug.Payload"))


Payload = _payload_class()
SPEED, AMPLITUDE, PHASE = "Speed", "DE X/Amplitude", "DE X/Phase"
NODE = "spBv1.0/works/{}/gateway"
DEVICE = NODE + "/pump"


def written(sequence: int, values: Mapping[Any, float | None], *, at: int = 0, names: bool = True) -> bytes:
    """A payload; keys are names, in a birth with their aliases, or aliases alone."""
    made = Payload(timestamp=START // 1_000_000 + at, seq=sequence)
    for alias, (name, value) in enumerate(values.items()):
        metric = made.metrics.add(datatype=10)
        if isinstance(name, str):
            metric.name = name
            if names:
                metric.alias = alias
        else:
            metric.alias = name
        if value is None:
            metric.is_null = True
        else:
            metric.double_value = value
    return bytes(made.SerializeToString())


def mapped(**changes: Any) -> Machine:
    """The machine with a mapping of one of its probes."""
    told = {"group": "works", "node": "gateway", "device": "pump", "speed": SPEED}
    channels = {"channels": {"B2X": {"amplitude": AMPLITUDE, "phase": PHASE}}}
    return parse_machine(document(sparkplug=told | channels | changes))


def nodes() -> SparkplugNodes:
    one = SparkplugNodes(epoch=7)
    one.follow([mapped()])
    return one


ALL = {SPEED: 900.0, AMPLITUDE: 12.5, PHASE: 30.0}


@few_examples
@given(
    st.integers(0, 255),
    st.integers(0, 2**63),
    st.floats(allow_nan=False),
    st.sampled_from([(1, -5), (2, -300), (3, -70_000), (4, -(2**40)), (7, 70_000), (8, 2**50)]),
)
def test_what_another_implementation_writes_is_read(sequence: int, moment: int, number: float, whole: tuple[int, int]) -> None:
    made = Payload(timestamp=moment, seq=sequence)
    made.metrics.add(name="a", alias=3, datatype=10, double_value=number)
    kind, value = whole
    if kind in (4, 8):
        made.metrics.add(name="b", datatype=kind, long_value=value % 2**64)
    else:
        made.metrics.add(name="b", datatype=kind, int_value=value % 2**32)
    made.metrics.add(alias=9, datatype=11, boolean_value=True)
    made.metrics.add(name="text", datatype=12, string_value="x")
    made.metrics.add(name="null", datatype=10, is_null=True)
    found = decoded(made.SerializeToString())
    assert (found.timestamp, found.sequence) == (moment, sequence)
    assert [(one.name, one.alias, one.value) for one in found.metrics] == [
        ("a", 3, number),
        ("b", None, value),
        (None, 9, 1.0),
        ("text", None, None),
        ("null", None, None),
    ]


@few_examples
@given(st.binary(max_size=200))
def test_nothing_else_than_a_refusal_comes_of_any_bytes(body: bytes) -> None:
    with suppress(Rejected):
        decoded(body)


def test_another_implementation_reads_the_request_for_names() -> None:
    read = Payload.FromString(rebirth(123_456))
    assert (read.timestamp, read.metrics[0].name, read.metrics[0].boolean_value) == (123_456, REBIRTH, True)


def test_values_are_those_of_the_birth_until_they_change() -> None:
    one = nodes()
    one.batches(NODE.format("NBIRTH"), written(0, {}))
    (born,) = one.batches(DEVICE.format("DBIRTH"), written(1, ALL))
    (then,) = one.batches(DEVICE.format("DDATA"), written(2, {1: 13.0}, at=1000))
    assert (born.source, born.epoch, born.sequence, then.sequence) == (SOURCE, 7, 0, 1)
    assert (born.amplitude, then.amplitude, then.phase, then.speed) == ([[12.5]], [[13.0]], [[30.0]], [900.0])
    assert then.time_ns == [START // 10**6 * 10**6 + 10**9]


def test_a_gap_is_counted_modulo_256_and_makes_values_unknown() -> None:
    one = nodes()
    one.batches(NODE.format("NBIRTH"), written(0, {}))
    one.batches(DEVICE.format("DBIRTH"), written(1, ALL))
    (after,) = one.batches(DEVICE.format("DDATA"), written(5, {0: 905.0}))
    assert after.sequence == 1 + 3
    assert after.amplitude == [[None]]
    assert [topic for topic, _ in one.rebirths()] == ["spBv1.0/works/NCMD/gateway"]
    assert list(one.rebirths()) == []
    (again,) = one.batches(DEVICE.format("DDATA"), written(5 + 256 - 256, {0: 910.0}, at=1))
    assert again.sequence == 5 + 255
    assert one.missing == 3 + 255


def test_the_same_message_again_is_no_sample_and_the_count_turns_over() -> None:
    one = nodes()
    one.batches(NODE.format("NBIRTH"), written(254, ALL))
    one.batches(DEVICE.format("DBIRTH"), written(255, ALL))
    told = written(0, {0: 901.0})
    assert len(one.batches(DEVICE.format("DDATA"), told)) == 1
    assert one.batches(DEVICE.format("DDATA"), told) == []
    assert one.missing == 0


def test_unknown_aliases_nodes_and_kinds_make_no_samples() -> None:
    one = nodes()
    assert one.batches(DEVICE.format("DDATA"), written(3, {0: 900.0})) == []
    assert len(list(one.rebirths())) == 1
    assert one.batches("spBv1.0/works/DDATA/another/pump", written(0, ALL)) == []
    assert one.batches("spBv1.0/STATE/host", b"\xff") == []
    with pytest.raises(Rejected, match="without seq"):
        one.batches(DEVICE.format("DDATA"), Payload(timestamp=1).SerializeToString())


def test_a_mapping_names_probes_that_there_are() -> None:
    with pytest.raises(Invalid, match=r"(?s)sparkplug.*B9X.*it has B2X, B2Y, B3X, B3Y"):
        mapped(channels={"B9X": {"amplitude": "a", "phase": "b"}})


def test_samples_come_from_a_broker_as_the_document_says(mosquitto: Mosquitto, taking: Taking) -> None:
    with taking.database.transaction() as session:
        machines.revise(session, mapped())
    with mosquitto.connected("edge", "", "spBv1.0/works/NCMD/#") as edge:
        wait_until(lambda: "spBv1.0/works/+/gateway/#" in taking.samples._nodes.filters)
        wait_until(lambda: bool(_told(edge, DEVICE.format("DDATA"), written(9, {0: 900.0}))))
        edge.publish(NODE.format("NBIRTH"), written(0, {}))
        edge.publish(DEVICE.format("DBIRTH"), written(1, ALL))
        for number in (2, 3, 6):
            edge.publish(DEVICE.format("DDATA"), written(number, ALL, at=1000 * number, names=False))
        edge.publish(DEVICE.format("DDATA"), b"\xff")
        wait_until(lambda: [(row.received, row.lost) for row in rows(taking.database)] == [(4, 2)])
        wait_until(lambda: rejected(taking.database).get("undecodable") == 1)
    (row,) = rows(taking.database)
    assert (row.machine_id, row.source) == (KEY.machine, SOURCE)


def _told(edge: Any, topic: str, payload: bytes) -> list[Any]:
    """Publish what needs names until the node is asked for them."""
    edge.publish(topic, payload, qos=0)
    return list(edge.heard)


def test_machines_without_a_mapping_are_left_alone(plant: Database) -> None:
    assert MappedMachines(plant).read() == []
