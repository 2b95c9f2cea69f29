"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import estimator, latency, many_sources, phasors, throughput, updated_model

if __name__ == "__main__":
    estimator.main([])
    print()
    updated_model.main([])
    print()
    phasors.main([])
    print()
    latency.main()
    print()
    throughput.main()
    print()
    many_sources.main()
