"""Conventions of all resources: dependencies, errors, paging, preconditions, units, times. It imports no resource; every
resource imports it.
"""
