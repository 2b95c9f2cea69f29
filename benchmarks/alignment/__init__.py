"""Alignment of couplings on oil films: how well offsets and angles are known, absolutely and against a baseline."""
