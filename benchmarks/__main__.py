"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import coast_down, estimator, latency, phasors, updated_model

if __name__ == "__main__":
    estimator.main([])
    print()
    updated_model.main([])
    print()
    phasors.main([])
    print()
    coast_down.main([])
    print()
    latency.main()
