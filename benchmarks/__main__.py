"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import estimator, latency, orbit_sense, phasors, updated_model

if __name__ == "__main__":
    estimator.main([])
    print()
    updated_model.main([])
    print()
    phasors.main([])
    print()
    orbit_sense.main([])
    print()
    latency.main()
