"""`python -m benchmarks.fleet`."""

from benchmarks.fleet.report import main

if __name__ == "__main__":
    main()
