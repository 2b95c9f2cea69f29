"""Benchmarks: each module prints the figures it measured beside the figures asked for."""
