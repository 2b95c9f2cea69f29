"""From the commit of an alert's transition to a listener and to webhooks, while many receivers hang, fail or are gone.

A real server, real HTTP receivers and the real dispatcher on loopback, over SQLite.
"""

import argparse
import json
import logging
import random
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import httpx
import psutil
import zenoh

from benchmarks.alert_changes import alerting_machine, change_alert
from benchmarks.serving import served
from service.configuration.settings import Settings
from service.delivery.dispatcher import Dispatcher
from service.messaging.session import open_session
from storage.alerts import deliveries

KINDS = {"hang": 30, "error": 30, "gone": 10, "ok": 30}
"""Number of the hundred receivers with each behaviour."""
TRANSITIONS = 400
RATE = 4.0
"""Transitions in a second."""
ELEMENTS = 40
"""Couplings whose alerts change at random."""
ASKED_STREAM, ASKED_WEBHOOK = 0.200, 1.000


class Times:
    """Times at which an event was committed, heard on the stream and taken by healthy webhooks [s, monotonic]."""

    def __init__(self) -> None:
        self.committed: dict[str, float] = {}
        self.heard: dict[str, float] = {}
        self.taken: dict[tuple[str, str], float] = {}
        self.repeated = 0
        self.lock = threading.Lock()


@contextmanager
def receivers(times: Times) -> Iterator[int]:
    """Yield the port of an HTTP server that plays all receivers."""
    over = threading.Event()

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_POST(self) -> None:
            moment = time.monotonic()
            self.rfile.read(int(self.headers["content-length"]))
            kind = self.path.split("/")[1]
            if kind == "hang":
                over.wait(120.0)
                self.close_connection = True
                return
            if kind == "ok":
                with times.lock:
                    known = (self.headers["webhook-id"], self.path)
                    times.repeated += known in times.taken
                    times.taken.setdefault(known, moment)
            self.send_response({"error": 500, "gone": 410}.get(kind, 204))
            self.send_header("content-length", "0")
            self.end_headers()

        def log_message(self, *_: Any) -> None:
            """Say nothing."""

    class WebhookServer(ThreadingHTTPServer):
        daemon_threads = True
        request_queue_size = 1024

    server = WebhookServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield server.server_address[1]
    finally:
        over.set()
        server.shutdown()
        server.server_close()
        thread.join()


def listen(url: str, times: Times, wanted: int) -> None:
    """Read the stream until all events came."""
    with httpx.stream("GET", f"{url}/alert-events/stream", params={"after": 0}, timeout=60.0, trust_env=False) as answer:
        for line in answer.iter_lines():
            if line.startswith("data: "):
                moment = time.monotonic()
                event = json.loads(line[6:])
                times.heard[f"alert-{event['alert']}-{event['number']}"] = moment
                if len(times.heard) >= wanted:
                    return


def quantiles(values: Sequence[float]) -> tuple[float, float, float]:
    """Return median, 99th percentile and largest value."""
    ordered = sorted(values)
    return statistics.median(ordered), ordered[min(len(ordered) - 1, int(0.99 * len(ordered)))], ordered[-1]


def run(folder: Path, transitions: int, seed: int) -> str:
    """Run the benchmark once; return its result as text."""
    logging.disable(logging.WARNING)
    rng, times = random.Random(seed), Times()
    database, number = alerting_machine(folder)
    process = psutil.Process()
    with ExitStack() as stack:
        port = stack.enter_context(receivers(times))
        with database.transaction() as session:
            for kind, count in KINDS.items():
                for one in range(count):
                    target = f"http://127.0.0.1:{port}/{kind}/{one}"
                    deliveries.subscribe(session, kind="webhook", name=f"{kind} {one}", target=target, secret="whsec_c2VjcmV0")
        network: zenoh.Session = stack.enter_context(open_session(listen=["tcp/127.0.0.1:0"], connect=[]))
        url = stack.enter_context(served(database))
        settings = Settings(delivery_networks=["127.0.0.0/8"])  # pydantic converts
        dispatcher = Dispatcher(database, network, settings)
        dispatcher.start()
        stack.callback(dispatcher.stop)
        listener = threading.Thread(target=listen, args=(url, times, transitions))
        listener.start()
        memory: list[float] = []
        for count in range(transitions):
            with database.transaction() as session:
                alert = change_alert(session, f"coupling.C{rng.randrange(ELEMENTS)}", number)
                event = f"alert-{alert.id}-{alert.event_count}"
            times.committed[event] = time.monotonic()
            if count % (transitions // 8) == 0:
                memory.append(process.memory_info().rss / 1e6)
            time.sleep(1.0 / RATE)
        listener.join(30.0)
        wanted = KINDS["ok"] * len(times.committed)
        deadline = time.monotonic() + 60.0
        while len(times.taken) < wanted and time.monotonic() < deadline:
            time.sleep(0.1)
        memory.append(process.memory_info().rss / 1e6)
        with database.reading() as session:
            gone = sum(row.state == "disabled" for row in deliveries.list_subscriptions(session))
    database.close()
    stream = quantiles([times.heard[event] - moment for event, moment in times.committed.items() if event in times.heard])
    webhook = quantiles([moment - times.committed[event] for (event, _), moment in times.taken.items()])
    kinds = ", ".join(f"{count} {kind}" for kind, count in KINDS.items())
    lines = [
        f"{len(times.committed)} transitions at {RATE:g}/s, seed {seed}, webhooks: {kinds}",
        f"  {'':<44}{'asked':>10}{'median':>10}{'p99':>10}{'largest':>10}",
        _figure("commit to event stream", ASKED_STREAM, stream),
        _figure("commit to healthy webhooks", ASKED_WEBHOOK, webhook),
        f"  heard {len(times.heard)} of {len(times.committed)}; taken {len(times.taken)} of {wanted}, "
        f"{times.repeated} repeated; {gone} of {KINDS['gone']} gone receivers disabled",
        "  memory of server, dispatcher and receivers [MB]: " + ", ".join(f"{value:.0f}" for value in memory),
    ]
    return "\n".join(lines)


def _figure(what: str, asked: float, found: tuple[float, float, float]) -> str:
    return f"  {what:<44}{f'< {1000 * asked:.0f} ms':>10}" + "".join(f"{1000 * value:>7.0f} ms" for value in found)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.delivery", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--transitions", type=int, default=TRANSITIONS)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        print(run(Path(folder), given.transitions, given.seed))


if __name__ == "__main__":
    main()
