"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import api_latency, cold_start, delivery, disk, latency, many_sources, mqtt, opcua, page_paint, throughput
from benchmarks.estimator import __main__ as estimator
from benchmarks.estimator import capture, coast_down, derived, orbit_sense, phasors, states, trend_tests, updated_model
from benchmarks.faults import alert_life
from benchmarks.fleet import report as fleet

WITH_OPTIONS = (
    estimator,
    updated_model,
    derived,
    phasors,
    coast_down,
    states,
    capture,
    orbit_sense,
    delivery,
    alert_life,
    trend_tests,
    fleet,
    page_paint,
    api_latency,
    opcua,
    mqtt,
)
WITHOUT = (latency, throughput, many_sources, disk, cold_start)

if __name__ == "__main__":
    for benchmark in WITH_OPTIONS:
        benchmark.main([])
        print()
    for plain in WITHOUT:
        plain.main()
        print()
