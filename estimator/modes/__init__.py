"""Modes of a train: eigenvalues, shapes, critical speeds, the Campbell diagram, and reduction of large meshes over many
speeds. It imports `rotor` and what lies below; `updated_model` adds what an identification knows of the uncertainty.
"""
