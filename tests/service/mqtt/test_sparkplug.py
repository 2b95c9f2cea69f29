"""Sparkplug B: payloads as another implementation writes them, gaps by the node's count, names by births."""

import re
from collections.abc import Mapping
from contextlib import suppress
from typing import Any

import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory  # type: ignore[import-untyped]
from hypothesis import given
from hypothesis import strategies as st

from estimator.errors import Invalid
from estimator.machine.document import Machine, parse_machine
from formats.wire import JSON, MESSAGEPACK, Rejected, decode_body, encode_body, to_samples
from service.mqtt.edge_node import EdgeNode
from service.mqtt.mapped_machines import MappedMachines
from service.mqtt.sparkplug_nodes import SOURCE, SparkplugNodes
from service.mqtt.sparkplug_payload import REBIRTH, decoded, rebirth
from storage.database.engine import Database
from storage.machines import machines
from tests.mosquitto import Mosquitto
from tests.plant import KEY, SECOND, START, document, few_examples, wait_until
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
    ("properties", 9, TYPES.TYPE_MESSAGE),
    ("int_value", 10, TYPES.TYPE_UINT32),
    ("long_value", 11, TYPES.TYPE_UINT64),
    ("float_value", 12, TYPES.TYPE_FLOAT),
    ("double_value", 13, TYPES.TYPE_DOUBLE),
    ("boolean_value", 14, TYPES.TYPE_BOOL),
    ("string_value", 15, TYPES.TYPE_STRING),
)
"""Fields of the public sparkplug_b.proto (Eclipse Tahu, EPL-2.0): names, numbers and types, as far as they are needed here."""

PAYLOAD = ".sparkplug.Payload"


def _payload_class() -> Any:
    file = descriptor_pb2.FileDescriptorProto(name="sparkplug_b.proto", package="sparkplug", syntax="proto2")
    payload = file.message_type.add(name="Payload")
    metric = payload.nested_type.add(name="Metric")
    properties = payload.nested_type.add(name="PropertySet")
    properties.field.add(name="keys", number=1, type=TYPES.TYPE_STRING, label=TYPES.LABEL_REPEATED)
    properties.field.add(
        name="values", number=2, type=TYPES.TYPE_MESSAGE, type_name=f"{PAYLOAD}.PropertyValue", label=TYPES.LABEL_REPEATED
    )
    value = payload.nested_type.add(name="PropertyValue")
    for name, number, kind in (("type", 1, TYPES.TYPE_UINT32), ("int_value", 3, TYPES.TYPE_UINT32)):
        value.field.add(name=name, number=number, type=kind, label=TYPES.LABEL_OPTIONAL)
    for name, number, kind in METRIC:
        of_type = {"type_name": f"{PAYLOAD}.PropertySet"} if kind == TYPES.TYPE_MESSAGE else {}
        metric.field.add(name=name, number=number, type=kind, label=TYPES.LABEL_OPTIONAL, **of_type)
    payload.field.add(name="timestamp", number=1, type=TYPES.TYPE_UINT64, label=TYPES.LABEL_OPTIONAL)
    payload.field.add(
        name="metrics", number=2, type=TYPES.TYPE_MESSAGE, type_name=f"{PAYLOAD}.Metric", label=TYPES.LABEL_REPEATED
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


def nodes(machine: Machine | None = None) -> SparkplugNodes:
    one = SparkplugNodes(epoch=7)
    one.follow([machine or mapped()])
    return one


def born(one: SparkplugNodes, *, at: int = 0, birth: float | None = None) -> None:
    """Let the node and its device be born. birth: number of the birth."""
    one.batches(NODE.format("NBIRTH"), written(0, {} if birth is None else {"bdSeq": birth}, at=at))
    one.batches(DEVICE.format("DBIRTH"), written(1, ALL, at=at))


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


def test_a_compressed_payload_is_refused_in_words() -> None:
    """Without a word it would be a message without metrics."""
    one = nodes()
    compressed = Payload(timestamp=1, seq=0).SerializeToString() + b"\x22\x12SPBV1.0_COMPRESSED" + b"\x2a\x03abc"
    with pytest.raises(Rejected, match="compressed"):
        one.batches(DEVICE.format("DDATA"), compressed)


def test_a_message_that_the_broker_sends_again_is_no_sample_and_no_gap() -> None:
    """After a broken connection those of quality 1 come again, several in a row."""
    one = nodes()
    born(one)
    told = [written(number, {0: 900.0 + number}, at=number) for number in (2, 3, 4)]
    found = [len(one.batches(DEVICE.format("DDATA"), body)) for body in (*told, *told)]
    assert found == [1, 1, 1, 0, 0, 0]
    (then,) = one.batches(DEVICE.format("DDATA"), written(5, {0: 910.0}, at=9))
    assert (one.missing, then.sequence) == (0, 4)


def test_a_devices_death_is_counted_and_makes_its_values_unknown() -> None:
    one = nodes()
    born(one)
    assert one.batches(DEVICE.format("DDEATH"), written(2, {})) == []
    assert one.batches(DEVICE.format("DDATA"), written(3, {1: 13.0}, at=1)) == [], "its speed is not known"
    (then,) = one.batches(DEVICE.format("DBIRTH"), written(4, ALL, at=2))
    assert (one.missing, then.sequence) == (0, 1)


def test_a_nodes_death_makes_all_unknown_and_that_of_an_earlier_birth_nothing() -> None:
    one = nodes()
    born(one, birth=4.0)
    one.batches(NODE.format("NDEATH"), written_death(3.0))
    assert len(one.batches(DEVICE.format("DDATA"), written(2, {1: 13.0}, at=1))) == 1
    one.batches(NODE.format("NDEATH"), written_death(4.0))
    assert one.batches(DEVICE.format("DDATA"), written(9, {1: 14.0}, at=2)) == []
    assert one.missing == 0, "what a dead node's count would be is not known"
    assert len(list(one.rebirths())) == 1


def written_death(birth: float) -> bytes:
    """The will of a node, which counts nothing but its births."""
    made = Payload(timestamp=START // 1_000_000)
    made.metrics.add(name="bdSeq", datatype=4, long_value=int(birth))
    return bytes(made.SerializeToString())


def test_a_node_that_is_first_heard_of_between_births_is_asked_for_what_it_said() -> None:
    """It says what changes only: a speed that stays would never come."""
    one = nodes()
    assert one.batches(DEVICE.format("DDATA"), written(17, {AMPLITUDE: 13.0})) == []
    assert [topic for topic, _ in one.rebirths()] == ["spBv1.0/works/NCMD/gateway"]


def test_a_changed_mapping_asks_for_what_was_not_kept() -> None:
    one = nodes()
    born(one)
    one.follow([mapped()])
    assert list(one.rebirths()) == []
    one.follow([mapped(conditions={"oil": "Oil/Temperature"}) if mapped().conditions else mapped(speed="Speed 2")])
    assert len(list(one.rebirths())) == 1


def test_samples_are_numbered_on_where_a_document_has_no_mapping_for_a_while() -> None:
    """Numbers that were given before would be those of duplicates: their samples would be lost without a word."""
    one = nodes()
    born(one)
    (before,) = one.batches(DEVICE.format("DDATA"), written(2, {1: 13.0}, at=1))
    one.follow([])
    one.follow([])
    one.follow([mapped()])
    one.batches(NODE.format("NBIRTH"), written(0, {}, at=2))
    (after,) = one.batches(DEVICE.format("DBIRTH"), written(1, ALL, at=2))
    assert (after.epoch, after.sequence) == (before.epoch, before.sequence + 1)


def test_a_metric_that_never_comes_is_said_and_asked_for_ever_more_rarely(caplog: pytest.LogCaptureFixture) -> None:
    one = nodes()
    one.batches(NODE.format("NBIRTH"), written(0, {}))
    one.batches(DEVICE.format("DBIRTH"), written(1, {AMPLITUDE: 1.0, PHASE: 2.0}))
    assert f"has no metric Speed, which the document of machine '{KEY.machine}' names" in caplog.text
    (node,) = one._nodes.values()
    asked = [moment for moment in range(0, 3600, 5) if _asks(node, float(moment))]
    assert 5 <= len(asked) <= 11, "10, 20, 40 … 600 s between"
    one.batches(DEVICE.format("DDATA"), written(9, {AMPLITUDE: 2.0}))
    assert node.rebirth_pause == 10.0, "a gap is a new reason"


def _asks(node: EdgeNode, moment: float) -> bool:
    node.wants_rebirth = True
    return node.claim_rebirth_request(moment)


@pytest.mark.parametrize(("quality", "value"), [(192, 12.5), (0, None), (500, None)])
def test_what_the_node_calls_bad_or_stale_is_no_value(quality: int, value: float | None) -> None:
    made = Payload(timestamp=START // 1_000_000, seq=1)
    for name, number in ALL.items():
        metric = made.metrics.add(name=name, datatype=10, double_value=number)
        if name == AMPLITUDE:
            metric.properties.keys.extend(["EngUnit", "Quality"])
            metric.properties.values.add(type=3, int_value=7)
            metric.properties.values.add(type=3, int_value=quality)
    (found,) = nodes().batches(DEVICE.format("DBIRTH"), made.SerializeToString())
    assert found.amplitude == [[value]]


GAP, OVERALL = "DE X/Gap", "DE X/Direct"
WITH_GAP = {"amplitude": AMPLITUDE, "phase": PHASE, "gap": GAP, "overall": OVERALL}


def with_gap(**changes: Any) -> Machine:
    """The machine with a mapping of gap and overall level of one probe beside one without."""
    told = document()
    for probe in told["probes"]:
        probe["gap_grows"] = "away"
    channels = {"B2X": WITH_GAP, "B2Y": {"amplitude": "DE Y/Amplitude", "phase": "DE Y/Phase"}}
    mapping = {"group": "works", "node": "gateway", "device": "pump", "speed": SPEED, "channels": channels}
    return parse_machine(told | {"sparkplug": mapping | changes})


def test_gap_and_overall_level_are_taken_where_the_document_names_their_metrics() -> None:
    one = nodes(with_gap())
    (told,) = one.batches(DEVICE.format("DBIRTH"), written(0, ALL | {GAP: -310.0, OVERALL: 40.0}))
    assert (told.gap, told.gap_unit, told.overall) == ([[-310.0, None]], "um", [[40.0, None]])
    (then,) = one.batches(DEVICE.format("DDATA"), written(1, {GAP: -300.0}, at=1))
    assert (then.gap, then.overall) == ([[-300.0, None]], [[40.0, None]])
    samples, taken, faults = to_samples(then, with_gap(), received_at=START + SECOND)
    column = with_gap().channels.index("B2X")
    assert taken.all()
    assert not faults
    assert samples.gap[0, column] == pytest.approx(300e-6), "away from the probe is against its axis"
    assert samples.overall[0, column] == pytest.approx(20e-6), "peak-to-peak"
    plain = nodes().batches(DEVICE.format("DBIRTH"), written(0, ALL))[0]
    assert (plain.gap, plain.gap_unit, plain.overall) == (None, None, None)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"channels": {"B2X": WITH_GAP}}, "a gap needs the probe's `gap_grows`"),
        ({"channels": {"B2X": WITH_GAP}, "gap_unit": "V"}, "a gap in V needs the probe's `sensitivity`"),
        ({"channels": {"B2X": WITH_GAP | {"rms": "x"}}}, "rms"),
        ({"gap_unit": "rpm"}, "gap_unit"),
    ],
)
def test_a_gap_that_could_not_be_reported_is_refused_with_the_document(change: dict[str, Any], words: str) -> None:
    with pytest.raises(Invalid, match=re.escape(words)):
        mapped(**change)


NUMBERS = st.one_of(st.floats(), st.none())


@few_examples
@given(st.integers(0, 2**64 - 1), st.lists(NUMBERS, min_size=5, max_size=5))
def test_whatever_a_node_sends_can_be_offered_and_judged(moment: int, numbers: list[float | None]) -> None:
    """A message that nobody could read would come again for ever."""
    made = Payload(timestamp=moment, seq=1)
    for name, number in zip((*ALL, GAP, OVERALL), numbers, strict=True):
        metric = made.metrics.add(name=name, datatype=10, is_null=number is None)
        if number is not None:
            metric.double_value = number
    for told in nodes(with_gap()).batches(DEVICE.format("DBIRTH"), made.SerializeToString()):
        for encoding in (JSON, MESSAGEPACK):
            read = decode_body(encode_body(told, encoding), encoding)
            with suppress(Rejected):
                to_samples(read, with_gap(), received_at=START)


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
