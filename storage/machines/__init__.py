"""Repositories of machine documents, baselines, limits, calibrations, slow-roll vectors, field balancings, timelines and
the fleet. They import `database` and `tables`; every part of the service reads the document in force from here.
"""
