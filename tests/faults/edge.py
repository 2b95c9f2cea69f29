"""A source in a process of its own, with a durable log: publishes what was measured at a steady pace, then answers queries.

After it was killed it goes on where its log ends.

    python -m tests.faults.edge <endpoint> <log> <samples> <samples per second>
"""

import signal
import sys
import threading
import time
from pathlib import Path

from formats.wire import BINARY
from service.messaging.session import session
from service.sources.publisher import Source
from service.sources.sqlite_replay_log import SqliteReplayLog
from tests.faults.measured import SIZE, measured
from tests.plant import KEY


def main() -> None:
    """Run until SIGTERM."""
    endpoint, path, samples, rate = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4])
    stop = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: stop.set())
    with session(listen=[], connect=[endpoint]) as stream:
        log = SqliteReplayLog(path, source=KEY.machine)
        with Source(stream, KEY, name="edge", encoding=BINARY, log=log) as source:
            due = time.monotonic()
            while source.sequence < samples and not stop.wait(max(0.0, due - time.monotonic())):
                source.publish(measured(source.sequence, min(SIZE, samples - source.sequence)))
                due += SIZE / rate
            stop.wait()


if __name__ == "__main__":
    main()
