"""Figures of calibration on measured and printed data: asked beside measured."""
