"""From publication to queryable over REST: a service process under a steady stream of samples of 8 channels.

Each sample is a message of its own and carries the time at which it was published; a reader polls the newest samples over
HTTP and notes when it first sees each. Polling is part of what is measured, as it would be for a dashboard.

    python -m benchmarks.latency [--seconds 30] [--rate 200]
"""

import argparse
import tempfile
import threading
import time
from datetime import datetime
from pathlib import Path

import msgspec
import numpy as np

from formats.wire import Key
from service.messaging.session import session, wait_connected
from service.sources.publisher import Source
from storage.clock import from_datetime
from tests.end_to_end.processes import Service, until
from tests.end_to_end.test_real_input import ROSS, ross_batch

P95_ASKED_S = 1.0


def publish(source: Source, *, rate: float, count: int, published: dict[int, int]) -> None:
    """Publish single samples at a steady rate; notes when, by the sample's time in microseconds."""
    template = ross_batch(seed=0, start_s=0)
    began = time.perf_counter()
    for i in range(count):
        time.sleep(max(0.0, began + i / rate - time.perf_counter()))
        row = i % 300
        moment = time.time_ns() // 1000 * 1000
        source.publish(
            msgspec.structs.replace(
                template,
                time_ns=[moment],
                # Slowly up and down, so that run collection has something to do.
                speed=[200.0 + 50.0 * float(np.sin(i / rate / 5.0))],
                amplitude=[template.amplitude[row]],
                phase=[template.phase[row]],
            )
        )
        published[moment // 1000] = moment


def measure(service: Service, *, seconds: float, rate: float) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Return the latency of every sample [s]."""
    count = int(seconds * rate)
    published: dict[int, int] = {}
    seen: dict[int, int] = {}
    with service.running(), session(listen=[], connect=[service.endpoint]) as stream:
        service.create(ROSS)
        wait_connected(stream, [service.endpoint], give_up=lambda _seconds: False)
        with Source(stream, Key("examples", ROSS), name="benchmark") as source:
            arguments = {"rate": rate, "count": count, "published": published}
            publisher = threading.Thread(target=publish, args=(source,), kwargs=arguments)
            publisher.start()

            def look() -> bool:
                answer = service.get(f"/machines/{ROSS}/samples", limit=int(2 * rate))
                arrived = time.time_ns()
                for text in answer["time"]:
                    seen.setdefault(from_datetime(datetime.fromisoformat(text)) // 1000, arrived)
                return len(seen) >= count

            until(look, within_s=seconds + 30, what=f"all {count} samples are queryable")
            publisher.join()
    return np.array([seen[key] - moment for key, moment in published.items()]) / 1e9


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--rate", type=float, default=200.0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        service = Service(Path(folder))
        try:
            latency = measure(service, seconds=options.seconds, rate=options.rate)
        finally:
            service.client.close()
    p50, p95, p99 = np.percentile(latency, [50, 95, 99])
    print(f"publication to queryable over REST, {options.rate:.0f} samples/s of 8 channels, {latency.size} samples")
    print(f"  p50 {p50:.3f} s   p95 {p95:.3f} s (asked: below {P95_ASKED_S} s)   p99 {p99:.3f} s   max {latency.max():.3f} s")


if __name__ == "__main__":
    main()
