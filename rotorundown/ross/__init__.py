"""Machines from models that ROSS saved: its elements, read from the file and laid out as sections of one shaft. It imports
`estimator` alone.
"""
