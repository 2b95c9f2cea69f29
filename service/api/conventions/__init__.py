"""Conventions of all resources: dependencies, errors, paging, preconditions, units, times. It imports `http`, `security`,
`secrets`, `export` and `identification`, and no resource; every resource imports it.
"""
