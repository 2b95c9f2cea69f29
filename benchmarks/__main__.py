"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import estimator, identification, latency

if __name__ == "__main__":
    identification.main([])
    print()
    estimator.main([])
    print()
    latency.main()
