"""Calibration on measured runs with known added unbalances: influence coefficients measured by trial runs, corrections from
them, and weights at the places that a plane has. It imports `updated_model` and what lies below.
"""
