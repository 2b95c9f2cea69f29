"""The smallest source: publishes phasors over zenoh and keeps no log; samples lost by the network are counted, not recovered.

python publisher.py tcp/127.0.0.1:7447 examples motor-pump B1L,B1R 600     # endpoint, plant, machine, channels, samples
"""

import json
import sys
import time
import zlib

import zenoh

endpoint, plant, machine, channels, samples = sys.argv[1:6]
names, epoch, batch_size = channels.split(","), time.time_ns(), 5
config = zenoh.Config()
for name, value in {"mode": "client", "connect/endpoints": [endpoint], "connect/timeout_ms": -1}.items():
    config.insert_json5(name, json.dumps(value))
units = {"speed_unit": "rpm", "amplitude_unit": "um", "amplitude_kind": "peak-to-peak"}
units |= {"phase_convention": "lag", "phase_unit": "deg", "direction": "positive"}


def measure() -> tuple[int, float, list[float], list[float]]:
    """Return the instrument's reading: time [ns], speed, amplitude and phase of each channel; read your instrument here."""
    time.sleep(0.02)
    return time.time_ns(), 1480.0, [25.0 for _ in names], [120.0 for _ in names]


with zenoh.open(config) as session:
    publisher = session.declare_publisher(f"rundown/v1/{plant}/{machine}/samples", encoding="application/json")
    while not publisher.matching_status.matching:  # type: ignore[attr-defined]  # nobody listens yet
        time.sleep(0.1)
    for sequence in range(0, int(samples), batch_size):
        times, speeds, amplitudes, phases = zip(*(measure() for _ in range(batch_size)), strict=True)
        head = {"schema": 1, "plant": plant, "machine": machine, "source": "publisher", "epoch": epoch, "sequence": sequence}
        table = {"channels": names, "time_ns": times, "speed": speeds, "amplitude": amplitudes, "phase": phases}
        body = json.dumps(head | units | table).encode()
        publisher.put(b"rundown/1 %d %08x\n" % (len(body), zlib.crc32(body)) + body)
    time.sleep(0.5)  # what is on its way may arrive
