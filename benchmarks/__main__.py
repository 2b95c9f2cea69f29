"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import (
    alert_life,
    api_latency,
    capture,
    coast_down,
    cold_start,
    delivery,
    derived,
    disk,
    estimator,
    latency,
    many_sources,
    orbit_sense,
    page_paint,
    phasors,
    states,
    throughput,
    trend_tests,
    updated_model,
)
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
)
WITHOUT = (latency, throughput, many_sources, disk, cold_start)

if __name__ == "__main__":
    for benchmark in WITH_OPTIONS:
        benchmark.main([])
        print()
    for plain in WITHOUT:
        plain.main()
        print()
