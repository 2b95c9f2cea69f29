"""`rundown edge`: the agent as a process, from its configuration to its end."""

import threading
from pathlib import Path

import msgspec

from formats.wire import Key
from service.edge.agent import Agent
from service.edge.configuration import ENCODINGS, EdgeConfiguration, read_configuration
from service.edge.topic import Topic
from service.messaging.access_control import from_environment
from service.messaging.session import session as zenoh_session
from service.messaging.session import wait_connected
from service.sources.publisher import Source
from service.sources.sqlite_replay_log import SqliteReplayLog

LINGER_S = 5.0
"""Time for which replay queries are answered with `--exit` [s]."""


def run_edge(path: Path, stop: threading.Event, *, leave: bool, speedup: float | None) -> None:
    """Run until `stop`; with `leave` until the files end. Raises UnreadableFile, StreamUnusable, AccessUnusable, LogError."""
    configuration = read_configuration(path)
    with zenoh_session(listen=[], connect=configuration.connect, security=from_environment()) as session:
        key = Key(configuration.plant, configuration.machine)
        with Source(
            session,
            key,
            name=configuration.source,
            encoding=ENCODINGS[configuration.encoding],
            log=open_log(configuration),
        ) as source:
            agent = Agent(configuration, source)
            source.declare_status(lambda: msgspec.json.encode(agent.status()))
            topic = configuration.waveforms.topic
            if topic is not None:
                rate = configuration.waveforms.sampling_rate
                with Topic(session, topic, configuration.columns, agent.conditions, sampling_rate=rate) as opened:
                    agent.follow(opened, stop)
                return
            # Readers that connect later get the samples from the log.
            agent.read_files(stop, speedup=speedup)
            if not leave:
                stop.wait()
            elif wait_connected(session, configuration.connect, give_up=stop.wait):
                stop.wait(LINGER_S)


def open_log(configuration: EdgeConfiguration) -> SqliteReplayLog:
    """Open the agent's log. Raises LogError."""
    log = configuration.log
    owner = f"{configuration.plant}/{configuration.machine}/{configuration.source}"
    return SqliteReplayLog(log.path, source=owner, samples=log.samples, payload_bytes=round(log.megabytes * (1 << 20)))
