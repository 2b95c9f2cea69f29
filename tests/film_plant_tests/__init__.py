"""Tests of the film plant: its films, trains, sweeps and documents."""
