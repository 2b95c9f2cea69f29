"""Figures of the estimator on trains in fluid films; `python -m benchmarks.fluid_film` prints them."""
