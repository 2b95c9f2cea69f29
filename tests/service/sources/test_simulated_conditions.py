"""The simulated plant sends the conditions that its machines' documents name, and lives under them."""

import json
import threading
from pathlib import Path

import numpy as np
import pytest
import yaml
import zenoh

from estimator.machine.document import Machine, parse_machine
from estimator.simulation.simulated_second_order import PART
from formats.wire import ALL_SAMPLES, Key, SampleBatch, decode_batch, to_samples
from service.sources.simulator import SimulationPlan, simulate
from tests.paths import EXAMPLES
from tests.plant import listened_to, machine, wait_until

PLAN = SimulationPlan(cycles=2, interval_s=86_400.0, samples=20, rate=100_000.0, seed=1, linger_s=0.0)


def published(router: zenoh.Session, client: zenoh.Session, train: Machine, truth: Path) -> list[SampleBatch]:
    """All batches of a simulation that a subscriber on the other side hears."""
    heard: list[SampleBatch] = []

    def listen(sample: zenoh.Sample) -> None:
        key = Key.parse(str(sample.key_expr))
        heard.append(decode_batch(key, sample.payload.to_bytes(), str(sample.encoding)))

    with router.declare_subscriber(ALL_SAMPLES, listen):
        wait_until(lambda: listened_to(client.declare_publisher("rundown/v1/plant-1/x/samples")))
        simulate(client, [(train, "healthy")], PLAN, truth, threading.Event())
        wait_until(lambda: sum(len(one.time_ns) for one in heard) >= 2 * (2 * PLAN.samples + 6))
    return heard


def test_conditions_are_those_of_the_cycle(router: zenoh.Session, client: zenoh.Session, tmp_path: Path) -> None:
    train = machine(id="warm", conditions=[{"name": "oil", "unit": "degC"}, {"name": "load", "unit": "%"}])
    heard = published(router, client, train, tmp_path / "truth.jsonl")
    told = [tuple(set(values) for values in (one.conditions or {}).values()) for one in heard]
    assert all(len(oil) == len(load) == 1 for oil, load in told)
    oils = {oil.pop() for oil, _ in told}
    assert len(oils) == 2  # one a cycle
    assert all(oil is not None and 30.0 < oil < 70.0 for oil in oils)


def test_gaps_of_a_machine_on_films_are_sent_as_its_document_says(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path
) -> None:
    said = yaml.safe_load((EXAMPLES / "motor-compressor.yaml").read_text(encoding="utf-8"))
    for probe, way in zip(said["probes"], ["away", "towards", "away"], strict=False):
        probe["gap_grows"] = way
    train = parse_machine(said)
    heard = published(router, client, train, tmp_path / "truth.jsonl")
    assert {one.gap_unit for one in heard} == {"um"}
    rows = [row for one in heard for row in one.gap or []]
    assert all(value is None for row in rows for value in row[3:])
    for column, sign in ((0, 1.0), (1, -1.0), (2, 1.0)):
        sent = [sign * value for row in rows if (value := row[column]) is not None]
        assert len(sent) == len(rows)
        assert all(800.0 < value < 1200.0 for value in sent)
        assert max(sent) - min(sent) > 2.0
    _, _, faults = to_samples(heard[0], train, received_at=heard[0].time_ns[-1])
    assert faults == []


def test_without_conditions_nothing_is_said_of_them(router: zenoh.Session, client: zenoh.Session, tmp_path: Path) -> None:
    heard = published(router, client, machine(id="plain"), tmp_path / "truth.jsonl")
    assert {one.conditions is None for one in heard} == {True}
    runs = [json.loads(line) for line in (tmp_path / "truth.jsonl").read_text().splitlines()]
    assert [run["kind"] for run in runs] == ["run-up", "run-down"] * 2
    assert runs[0]["parameters"]["bearing.B1.kxx"] == pytest.approx(2e6, rel=0.4)


def test_overall_levels_are_sent_that_hold_the_1x_and_none_beyond_what_a_probe_sees(
    router: zenoh.Session, client: zenoh.Session, tmp_path: Path
) -> None:
    train = machine(id="levels")
    heard = published(router, client, train, tmp_path / "truth.jsonl")
    pairs = [
        (level, first)
        for one in heard
        for levels, row in zip(one.overall or [], one.amplitude, strict=True)
        for level, first in zip(levels, row, strict=True)
    ]
    assert len(pairs) == sum(len(one.time_ns) for one in heard) * len(train.channels)
    told = [(level, first) for level, first in pairs if level is not None and first is not None]
    assert told
    assert all(0.99 * first - 1.0 <= level <= 1.11 * first + 12.0 for level, first in told)
    samples, _, faults = to_samples(heard[0], train, received_at=heard[0].time_ns[-1])
    assert faults == []
    assert samples.overall.shape == samples.phasor.shape


def test_the_2x_is_sent_beside_the_1x(router: zenoh.Session, client: zenoh.Session, tmp_path: Path) -> None:
    train = machine(id="second")
    heard = published(router, client, train, tmp_path / "truth.jsonl")
    assert all(one.amplitude_2x is not None and one.phase_2x is not None for one in heard)
    over: list[float] = []
    for batch in heard:
        samples, _, faults = to_samples(batch, train, received_at=batch.time_ns[-1])
        assert faults == []
        large = np.abs(samples.phasor) > 20e-6
        over += (np.abs(samples.second)[large] / np.abs(samples.phasor)[large]).tolist()
    assert over
    assert np.median(over) == pytest.approx(PART, rel=0.3)
