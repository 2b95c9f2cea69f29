"""A thousand clients of the event stream of which a hundred never read: the service's memory, and whether anybody misses any.

python -m benchmarks.faults.stream_clients [--clients 1000] [--stuck 100] [--events 1000]
"""

import argparse
import tempfile
from pathlib import Path

from tests.faults.stream_clients import followed

LARGEST_GROWTH_MB = 200.0


def main() -> None:
    """Print the figures; status 1 when memory grew more than asked."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--clients", type=int, default=1000)
    parser.add_argument("--stuck", type=int, default=100)
    parser.add_argument("--events", type=int, default=1000, help="in hundreds")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        found = followed(Path(folder), clients=options.clients, stuck=options.stuck, events=options.events)
    print(f"{found}; asked: +{LARGEST_GROWTH_MB:.0f} MB")
    if found.growth_mb > LARGEST_GROWTH_MB:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
