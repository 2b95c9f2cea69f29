"""All benchmarks, one after the other: `python -m benchmarks`."""

from benchmarks import identification, latency

if __name__ == "__main__":
    identification.main()
    print()
    latency.main()
